"""The arrows of a sequence diagram, and where everything stands in it; `templates/sequence.svg` draws it.

The report of a grade and the recorder of a lab draw theirs with it. An SVG says nothing to readers who do not see it
beyond its summary, so whoever shows it puts the same steps beside it in words.
"""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Sequence

_TEMPLATES = Path(__file__).with_name("templates")
STYLE_SHEET = _TEMPLATES / "sequence.css"  # for the page that shows a drawing
_WIDTH = 640  # user units, one of which is a pixel; a drawing is as wide unless its lifelines need more
_GAP = 220  # between two lifelines at least, so that a short message stands on one or two lines
_BOX = (102, 190)  # the least and the greatest width of a name's box
_CHARACTER = 7.3  # width of a character of 12 px monospace
_LINE = 15  # height of a line of text
_ARROW = 16  # height of an arrow below its text
_BELOW_NOTE = 6
_MOST_LINES = 6  # of one step; the words beside the drawing have the rest
_MARGIN = 30  # around a text between two lifelines


_OfGoals = Literal["goal", "goal response", "feedback", "cancel request", "cancel response", "result"]
Kind = Literal["request", "response", "message", "failure", "note"] | _OfGoals


@dataclass(frozen=True)
class Arrow:
    """One thing that was sent; or, as a "failure", that never came; or, as a "note", a remark between the arrows."""

    sender: str
    receiver: str
    kind: Kind
    text: str
    channel: str = ""

    def __str__(self) -> str:
        """The arrow as a line of a list, without its channel."""
        fault = ", not as expected" if self.kind == "failure" else ""
        return self.text if self.kind == "note" else f"{self.sender} -> {self.receiver}{fault}: {self.text}"


def sequence_svg(steps: Sequence[tuple[Arrow, str]], names: dict[str, str], summary: str) -> str:
    """The diagram as an `svg` element, which templates take as it is; empty without steps."""
    if not steps:
        return ""
    box, places, width = _lifelines(list(names), max(len(name) for name in names.values()))
    heads = [(name, places[name], _wrap_label(label, box - 10, 3)) for name, label in names.items()]
    top = 19 + _LINE * max(len(lines) for _, _, lines in heads)
    rows, y = [], top
    for step, text in steps:
        begin, end, middle, lines = _place_step(step, text, places, width)
        bottom = y + len(lines) * _LINE
        rows.append((step.kind, lines, y, bottom + 4, begin, end, middle))
        y = bottom + (_BELOW_NOTE if step.kind == "note" else _ARROW)
    return render_template(
        _TEMPLATES / "sequence.svg",
        rows=rows,
        heads=heads,
        box=box,
        top=top,
        line=_LINE,
        width=width,
        height=y + 2,
        summary=summary,
    )


def _lifelines(names: list[str], longest: int) -> tuple[int, dict[str, int], int]:
    """The width of a name's box, where each lifeline is, and the width of it all."""
    least, most = _BOX
    box = min(max(least, int(longest * _CHARACTER) + 12), most) // 2 * 2
    edge = box // 2 + 5
    gap = max(_GAP, (_WIDTH - 2 * edge) // max(1, len(names) - 1))
    places = {name: edge + gap * number for number, name in enumerate(names)}
    return box, places, max(_WIDTH, places[names[-1]] + edge)


def _place_step(step: Arrow, text: str, places: dict[str, int], width: int) -> tuple[int, int, int, list[str]]:
    begin, end = places[step.sender], places[step.receiver]
    if step.kind == "note":
        middle, room = width // 2, width
    elif begin == end:  # beside the lifeline, on the side where there is more room
        room = min(_GAP, max(begin, width - begin))
        middle = begin + room // 2 if width - begin >= begin else begin - room // 2
    else:
        middle, room = (begin + end) // 2, abs(end - begin)
    lines = _wrap_label(("✗ " if step.kind == "failure" else "") + text, room - _MARGIN, _MOST_LINES)
    return begin, end, middle, lines


def _wrap_label(text: str, room: int, most: int) -> list[str]:
    lines = textwrap.wrap(text, int(room / _CHARACTER), break_on_hyphens=False) or [""]
    return lines if len(lines) <= most else [*lines[: most - 1], lines[most - 1][:-1] + "…"]
