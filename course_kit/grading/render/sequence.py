"""The sequence diagram of a failed check. The same steps stand below it as a list, for readers who do not see it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.exchange_log import GRADER, NODE
from course_kit.ros import sequence

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.ros.arrows import Arrow


def sequence_svg(steps: Sequence[Arrow]) -> str:
    """The diagram as an `svg` element, which templates take as it is; empty without steps.

    Args:
        steps: what happened, in order; their texts may hold anything.
    """
    return sequence.sequence_svg([(step, step.text) for step in steps], {GRADER: GRADER, NODE: NODE}, summary(steps))


def summary(steps: Sequence[Arrow]) -> str:
    """What the diagram shows, in one sentence."""
    count = sum(step.kind != "note" for step in steps)
    failed = " The last one failed." if any(step.kind == "failure" for step in steps) else ""
    words = f"{count} step{'' if count == 1 else 's'}"
    return f"Sequence diagram of {words} between the {GRADER} and {NODE}.{failed} The list below says the same."
