"""Replacements inside rclpy that can all be taken back."""

from __future__ import annotations

from typing import Any

_MISSING = object()


class Patches:
    """A stack of replaced attributes; `undo` restores them, last first."""

    def __init__(self) -> None:
        self._replaced: list[tuple[Any, str, Any]] = []

    def set(self, owner: Any, name: str, replacement: Any) -> Any:
        """Replace an attribute of a module, a class or an object.

        Returns:
            what was there before.
        """
        before = getattr(owner, name)
        own = vars(owner).get(name, _MISSING)
        self._replaced.append((owner, name, own))
        setattr(owner, name, replacement)
        return before

    def undo(self) -> None:
        """Put everything back."""
        while self._replaced:
            owner, name, own = self._replaced.pop()
            if own is _MISSING:
                delattr(owner, name)
            else:
                setattr(owner, name, own)
