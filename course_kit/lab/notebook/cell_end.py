"""What is said at the end of a cell: of verbs that were not awaited, and of what an error means."""

from __future__ import annotations

import asyncio
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from course_kit.lab.errors import LabError
from course_kit.lab.runtime.advice import advice_on

if TYPE_CHECKING:
    from course_kit.lab.awaiting import Pending


class NotAwaited:
    """The verbs that the running cell has called and not awaited."""

    def __init__(self) -> None:
        self._verbs: list[Pending[Any]] = []

    def expect(self, verb: Pending[Any], *, awaited: bool) -> None:
        """A verb was called, or awaited."""
        if awaited:
            self._verbs = [one for one in self._verbs if one is not verb]
        else:
            self._verbs.append(verb)

    def tell(self) -> None:
        """The cell has ended: say which ones nothing has awaited, nor will."""
        verbs, self._verbs = self._verbs, []
        coming: list[Any] = []
        with suppress(RuntimeError):  # a terminal has no loop
            coming = [task.get_coro() for task in asyncio.all_tasks()]
        missing = [verb for verb in verbs if not verb.told and not any(one is verb for one in coming)]
        for sentence in dict.fromkeys(map(repr, missing)):
            sys.stderr.write(f"{sentence}\n")


def tell_meaning(result: Any) -> None:
    """Say what a cell's error means, where Python's or rclpy's words do not."""
    error = getattr(result, "error_in_exec", None)
    if not isinstance(error, BaseException) or isinstance(error, LabError):
        return
    if meant := advice_on(error):
        sys.stderr.write(f"{meant}\n")
