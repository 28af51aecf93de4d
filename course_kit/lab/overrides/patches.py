"""Replacements inside rclpy that can all be taken back."""

from __future__ import annotations

import contextlib
from typing import Any

_MISSING = object()


class Patches:
    """A stack of replaced attributes; `undo` restores them, last first."""

    def __init__(self) -> None:
        self._replaced: list[tuple[Any, str, Any]] = []

    def set(self, owner: Any, name: str, replacement: Any) -> None:
        """Replace an attribute of a module, a class or an object."""
        self._replaced.append((owner, name, vars(owner).get(name, _MISSING)))
        setattr(owner, name, replacement)

    def undo(self) -> None:
        while self._replaced:
            owner, name, own = self._replaced.pop()
            if own is _MISSING:
                delattr(owner, name)
            else:
                setattr(owner, name, own)


def quieten_finalizers(patches: Patches) -> None:
    """Keep an executor that is collected from complaining about what is gone already; nobody could do anything then."""
    from rclpy.exceptions import InvalidHandle
    from rclpy.executors import Executor

    finalize = Executor.__del__
    harmless = contextlib.suppress(AttributeError, ValueError, InvalidHandle)  # kept: at the very end modules are empty

    def finalize_quietly(executor: Executor) -> None:
        with harmless:
            finalize(executor)

    patches.set(Executor, "__del__", finalize_quietly)
