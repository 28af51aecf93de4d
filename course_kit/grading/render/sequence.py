"""Draws the steps of a failed check as a sequence diagram: inline SVG, without scripts, ids or files beside it.

It takes its colours from the page, so that it fits light and dark; a step that failed has a cross and a word, not only
a colour. The same steps stand below it as a list, for readers who do not see it.
"""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from course_kit.grading.exchange_log import GRADER, NODE
from course_kit.grading.output import escaped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.exchange_log import Step

_WIDTH = 640  # user units, one of which is a pixel where there is room
_PLACES = {GRADER: 56, NODE: 584}
_BOX = (104, 24)
_LINE = 15  # height of a line of text
_GAP = 12  # below an arrow
_COLUMNS = 68  # characters of 12 px monospace between the two lifelines
_HEAD = 7  # length of an arrow's head


def sequence_svg(steps: Sequence[Step]) -> str:
    """The diagram as an `svg` element; empty without steps.

    Args:
        steps: what happened, in order; their texts may hold anything.
    """
    if not steps:
        return ""
    parts, y = [], _BOX[1] + 10
    for step in steps:
        drawn, y = _step(step, y)
        parts.append(drawn)
    height = y + 2
    lifelines = "".join(_lifeline(name, x, height) for name, x in _PLACES.items())
    return (
        f'<svg class="ck-sequence" viewBox="0 0 {_WIDTH} {height}" width="{_WIDTH}" height="{height}" role="img" '
        f'aria-label="{escaped(summary(steps))}">{lifelines}{"".join(parts)}</svg>'
    )


def summary(steps: Sequence[Step]) -> str:
    """What the diagram shows, in one sentence."""
    count = sum(step.kind != "note" for step in steps)
    failed = " The last one failed." if any(step.kind == "failure" for step in steps) else ""
    words = f"{count} step{'' if count == 1 else 's'}"
    return f"Sequence diagram of {words} between the {GRADER} and {NODE}.{failed} The list below says the same."


def _lifeline(name: str, x: int, height: int) -> str:
    width, tall = _BOX
    return (
        f'<line x1="{x}" y1="{tall}" x2="{x}" y2="{height}" class="ck-life"/>'
        f'<rect x="{x - width // 2 + 1}" y="1" width="{width - 2}" height="{tall - 2}" rx="3" class="ck-box"/>'
        f'<text x="{x}" y="16" text-anchor="middle">{name}</text>'
    )


def _step(step: Step, y: int) -> tuple[str, int]:
    """One step drawn below `y`, and where the next one begins."""
    middle = _WIDTH // 2
    kind = step.kind if step.kind in ("failure", "note") else "wire"
    sign = "✗ " if kind == "failure" else ""
    lines = textwrap.wrap(sign + step.text, _COLUMNS)
    spans = "".join(
        f'<text x="{middle}" y="{base}" text-anchor="middle" class="ck-{kind}">{escaped(line)}</text>'
        for base, line in zip(range(y + 11, y + 11 + len(lines) * _LINE, _LINE), lines, strict=True)
    )
    y += len(lines) * _LINE + 4
    if step.kind == "note":
        return spans, y + 2
    return spans + _arrow(step, y), y + _GAP


def _arrow(step: Step, y: int) -> str:
    begin, end = _PLACES[step.sender], _PLACES[step.receiver]
    forward = 1 if end > begin else -1
    dashed = " ck-back" if step.kind in ("response", "failure") else ""
    if step.kind == "failure":  # it never arrives: the line ends half way, at a cross
        end = (begin + end) // 2
        cross = f"M{end - 5} {y - 5}l10 10M{end - 5} {y + 5}l10 -10"
        return f'<path d="M{begin} {y}H{end}" class="ck-fail{dashed}"/><path d="{cross}" class="ck-fail"/>'
    head = f"M{end - forward * _HEAD} {y - 4}L{end} {y}L{end - forward * _HEAD} {y + 4}"
    filled = " ck-filled" if step.kind == "request" else ""
    return f'<path d="M{begin} {y}H{end}" class="ck-arrow{dashed}"/><path d="{head}" class="ck-arrow{filled}"/>'
