"""The drawing: an SVG in a page, numbered lines everywhere else.

The page needs nothing but itself. The lines say the same in words, for a screen reader, a terminal and a stored
notebook; neither holds times or identifiers.
"""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.lab.recording.arrows import arrows_of
from course_kit.ros.names import short_name
from course_kit.ros.sequence import STYLE_SHEET, Arrow, sequence_svg
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.lab.recording.events import Event

_TEMPLATE = Path(__file__).with_name("templates") / "exchange.html"
WIDTH = 80
_EMPTY = "Nothing has been recorded yet: call a service, then draw again."
_UNNAMED = frozenset({"message", "failure"})  # a topic has nothing else; a failure says itself what it is


class Diagram:
    """A sequence diagram that a notebook displays."""

    def __init__(self, arrows: Sequence[Arrow], left_out: int = 0) -> None:
        self.arrows = list(arrows)
        self.left_out = left_out

    @property
    def participants(self) -> list[str]:
        return list(dict.fromkeys(name for arrow in self.arrows for name in (arrow.sender, arrow.receiver)))

    def html(self) -> str:
        """The diagram as HTML: the drawing, a slider to go through it step by step, and the steps in words."""
        names = {name: short_name(name) for name in self.participants}
        steps = [(arrow, _line(_label(arrow))) for arrow in self.arrows]
        missing = self._describe_left_out() if self.left_out else ""
        if missing:
            first = next(iter(names))
            steps.insert(0, (Arrow(first, first, "note", missing), missing))
        words = [f"{_ends(arrow)}  {_line(_label(arrow))}" for arrow in self.arrows]
        return str(
            render_template(
                _TEMPLATE,
                drawing=sequence_svg(steps, names, f"Sequence diagram: {self._summary()}"),
                sequence_css=render_template(STYLE_SHEET),
                steps=words,
                missing=missing,
                summary=self._summary(),
            )
        )

    def __str__(self) -> str:
        """The diagram in numbered lines of at most 80 columns."""
        if not self.arrows:
            return _EMPTY
        lines = [self._describe_left_out()] if self.left_out else []
        digits = len(str(len(self.arrows)))
        for number, arrow in enumerate(self.arrows, 1):
            text = f"{number:>{digits}}. {_ends(arrow)}  {_line(_label(arrow))}"
            lines += textwrap.wrap(text, WIDTH, subsequent_indent=" " * (digits + 4), break_on_hyphens=False)
        return "\n".join(lines)

    def __repr__(self) -> str:
        return str(self)

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        if not self.arrows:
            return {"text/plain": _EMPTY}
        return {"text/html": self.html(), "text/plain": str(self)}

    def _summary(self) -> str:
        names = ", ".join(short_name(name) for name in self.participants)
        count = len(self.arrows)
        return f"{count} {'message' if count == 1 else 'messages'} between {names}."

    def _describe_left_out(self) -> str:
        return f"{self.left_out} earlier {'line is' if self.left_out == 1 else 'lines are'} left out."


def _label(arrow: Arrow) -> str:
    if arrow.kind in _UNNAMED:
        return f"{arrow.channel} {arrow.text}"
    return f"{arrow.channel} {arrow.kind}" + (f": {arrow.text}" if arrow.text else "")


def _ends(arrow: Arrow) -> str:
    sign = "--x" if arrow.kind == "failure" else "->"
    return f"{short_name(arrow.sender)} {sign} {short_name(arrow.receiver)}"


def _line(text: str) -> str:
    return " ".join(text.split())


DRAWN = 60  # arrows, unless the caller wants another number


def draw_diagram(events: list[Event], last: int | None = None) -> Diagram:
    """Draw the latest arrows, `last` of them at most."""
    arrows = arrows_of(events)
    count = DRAWN if last is None else max(0, last)
    return Diagram(arrows[len(arrows) - min(count, len(arrows)) :], left_out=max(0, len(arrows) - count))
