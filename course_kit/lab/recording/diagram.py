"""The drawing: an SVG in a page, numbered lines everywhere else.

The page needs nothing but itself: it is the same in JupyterLab and Notebook 7, in an HTML or slides export, offline,
and in the colours of the theme. The lines say the same in words, so that a screen reader, a terminal and a stored
notebook have it too; neither holds times or identifiers.
"""

from __future__ import annotations

import re
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.ros.names import short_name
from course_kit.ros.sequence import Arrow, sequence_css, sequence_svg
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Sequence

_TEMPLATE = Path(__file__).with_name("templates") / "exchange.html"
WIDTH = 80
_EMPTY = "Nothing has been recorded yet: call a service, then draw again."
_LINES = {
    "request": "->>",
    "response": "-->>",
    "message": "-)",
    "failure": "--x",
    "goal": "->>",
    "goal response": "-->>",
    "feedback": "-)",
    "cancel request": "->>",
    "cancel response": "-->>",
    "result": "-->>",
}
_UNNAMED = frozenset({"message", "failure"})  # a topic has nothing else; a failure says itself what it is
# What Mermaid reads as text and nothing else. Letters of all scripts and emoji are; # and ; and { are not.
_UNSAFE = re.compile(r"[^\w /=.,:()'\[\]+*!?\"\U0001F000-\U0001FAFF-]")
# "end" closes a block wherever it stands as a word.
_END = re.compile(r"\b(e)(nd)\b", re.IGNORECASE)


class Diagram:
    """A sequence diagram that a notebook displays."""

    def __init__(self, arrows: Sequence[Arrow], left_out: int = 0) -> None:
        self.arrows = list(arrows)
        self.left_out = left_out

    @property
    def participants(self) -> list[str]:
        """The nodes in the order of their first appearance."""
        return list(dict.fromkeys(name for arrow in self.arrows for name in (arrow.sender, arrow.receiver)))

    def mermaid(self) -> str:
        """The diagram in Mermaid's language."""
        names = self.participants
        keys = {name: f"n{number}" for number, name in enumerate(names, 1)}
        lines = ["sequenceDiagram"]
        lines.append("    accTitle: What crossed between the nodes")
        lines.append(f"    accDescr: {_escape(self._summary())}")
        lines += [f"    participant {keys[name]} as {_escape(short_name(name))}" for name in names]
        if self.left_out:
            lines.append(f"    Note over {keys[names[0]]}: {self._missing()}")
        for arrow in self.arrows:
            ends = f"{keys[arrow.sender]}{_LINES[arrow.kind]}{keys[arrow.receiver]}"
            lines.append(f"    {ends}: {_escape(_label(arrow))}")
        return "\n".join(lines) + "\n"

    def html(self) -> str:
        """The diagram as HTML: the drawing, a slider to go through it step by step, and the steps in words."""
        names = {name: short_name(name) for name in self.participants}
        steps = [(arrow, _line(_label(arrow))) for arrow in self.arrows]
        missing = self._missing() if self.left_out else ""
        if missing:
            first = next(iter(names))
            steps.insert(0, (Arrow(first, first, "note", missing), missing))
        words = [f"{_ends(arrow)}  {_line(_label(arrow))}" for arrow in self.arrows]
        return str(
            render_template(
                _TEMPLATE,
                drawing=sequence_svg(steps, names, f"Sequence diagram: {self._summary()}"),
                sequence_css=sequence_css(),
                steps=words,
                missing=missing,
                summary=self._summary(),
            )
        )

    def __str__(self) -> str:
        """The diagram in numbered lines of at most 80 columns."""
        if not self.arrows:
            return _EMPTY
        lines = [self._missing()] if self.left_out else []
        digits = len(str(len(self.arrows)))
        for number, arrow in enumerate(self.arrows, 1):
            said = f"{number:>{digits}}. {_ends(arrow)}  {_line(_label(arrow))}"
            lines += textwrap.wrap(said, WIDTH, subsequent_indent=" " * (digits + 4), break_on_hyphens=False)
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

    def _missing(self) -> str:
        return f"{self.left_out} earlier {'line is' if self.left_out == 1 else 'lines are'} left out."


def _label(arrow: Arrow) -> str:
    if arrow.kind in _UNNAMED:
        return f"{arrow.channel} {arrow.text}"
    return f"{arrow.channel} {arrow.kind}" + (f": {arrow.text}" if arrow.text else "")


def _ends(arrow: Arrow) -> str:
    return f"{short_name(arrow.sender)} {arrow.sign} {short_name(arrow.receiver)}"


def _line(text: str) -> str:
    return " ".join(text.split())


def _escape(text: str) -> str:
    """Text that Mermaid shows as it is: what it would read as its own language goes as an entity, `#59;` for `;`."""
    escaped = _UNSAFE.sub(lambda found: f"#{ord(found[0])};", _line(text))
    return _END.sub(lambda found: f"#{ord(found[1])};{found[2]}", escaped)
