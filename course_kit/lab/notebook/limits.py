"""How much a cell may print: a page with millions of characters does not react any more."""

from __future__ import annotations

from collections import deque

LINES = 2_000
CHARACTERS = 200_000
_LAST = 20  # lines shown of what was left out


class CellLimit:
    """What the running cell has printed to one stream."""

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """A cell begins."""
        self._lines = self._characters = 0
        self._left_out = 0
        self._last: deque[str] = deque(maxlen=_LAST)

    def take(self, text: str) -> str:
        """What of this text is shown."""
        if self._lines >= LINES or self._characters >= CHARACTERS:
            self._leave_out(text)
            return ""
        lines = text.splitlines(keepends=True)[: LINES - self._lines]
        shown = "".join(lines)[: CHARACTERS - self._characters]
        self._lines += shown.count("\n")
        self._characters += len(shown)
        if self._lines < LINES and self._characters < CHARACTERS:
            return shown
        self._leave_out(text[len(shown) :])
        ending = "" if shown.endswith("\n") else "\n"
        return f"{shown}{ending}... This cell has printed {self._how_much()}: the rest is left out.\n"

    def _leave_out(self, text: str) -> None:
        self._left_out += text.count("\n")
        self._last.extend(text[-CHARACTERS:].splitlines(keepends=True)[-_LAST:])

    def end(self) -> str:
        """What is said at the end of the cell: how much was left out, and the last of it."""
        if not self._left_out:
            return ""
        last = "".join(self._last)[-CHARACTERS // 10 :]
        left_out = max(self._left_out - last.count("\n"), 0)
        self._left_out = 0
        self._last.clear()
        return f"... {left_out:,} lines were left out. The last ones:\n{last}"

    def _how_much(self) -> str:
        return f"{LINES:,} lines" if self._lines >= LINES else f"{CHARACTERS:,} characters"
