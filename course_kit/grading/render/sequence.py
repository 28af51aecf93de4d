"""Where everything stands in the sequence diagram of a failed check; `sequence.svg` draws it.

The same steps stand below it as a list, for readers who do not see it.
"""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.exchange_log import GRADER, NODE
from course_kit.text.templates import render

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.ros.arrows import Arrow

_TEMPLATE = Path(__file__).with_name("templates") / "sequence.svg"
_TOP = 34  # user units, one of which is a pixel where there is room; above it stand the names
_LINE = 15  # height of a line of text
_ARROW = 16  # height of an arrow below its text
_GAP = 6  # below a note
_COLUMNS = 68  # characters of 12 px monospace between the two lifelines


def sequence_svg(steps: Sequence[Arrow]) -> str:
    """The diagram as an `svg` element, which templates take as it is; empty without steps.

    Args:
        steps: what happened, in order; their texts may hold anything.
    """
    if not steps:
        return ""
    rows, y = [], _TOP
    for step in steps:
        sign = "✗ " if step.kind == "failure" else ""
        lines = textwrap.wrap(sign + step.text, _COLUMNS)
        rows.append((step, lines, y))
        y += len(lines) * _LINE + (_GAP if step.kind == "note" else _ARROW)
    places = {GRADER: 56, NODE: 584}
    return render(_TEMPLATE, rows=rows, places=places, line=_LINE, height=y + 2, summary=summary(steps))


def summary(steps: Sequence[Arrow]) -> str:
    """What the diagram shows, in one sentence."""
    count = sum(step.kind != "note" for step in steps)
    failed = " The last one failed." if any(step.kind == "failure" for step in steps) else ""
    words = f"{count} step{'' if count == 1 else 's'}"
    return f"Sequence diagram of {words} between the {GRADER} and {NODE}.{failed} The list below says the same."
