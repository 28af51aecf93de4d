"""A node's `__init__` that does not end: nothing else in the notebook can run, and nobody would say why."""

from __future__ import annotations

import sys
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_kit.lab.runtime.callback_errors import where_is

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.lab.runtime.callback_errors import Locate

_SLOW = 3.0  # seconds


@contextmanager
def told_if_slow(node_class: object, locate: Locate, tell: Callable[[str], None]) -> Iterator[None]:
    """Say where `__init__` is when it takes longer than any needs."""
    starting = threading.get_ident()

    def look() -> None:
        at = where_is(sys._current_frames().get(starting), locate)  # noqa: SLF001 - the documented way to look
        where = f" ({at[0]}: {at[1]})" if at else ""
        name = getattr(node_class, "__name__", "The class")
        tell(
            f"{name}.__init__ has not ended after {_SLOW:g} s{where}. lab.start() waits for it. Is it a loop? Press "
            "Stop, and move what repeats into a timer: self.create_timer(seconds, self.method)."
        )

    timer = threading.Timer(_SLOW, look)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
