"""Declared checks of how often messages come."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.starting import ensure_up
from course_kit.grading.checks.declared.wanted import topic_of
from course_kit.grading.checks.topics import await_next
from course_kit.grading.diagnosis.hangs import told

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration

_OFF_BY = 0.2  # of the period; a machine is now and then busy
_PERIODS = 10  # that are watched at most
_FEWEST = 3  # messages; enough to forget one that a busy machine has delayed
_SILENT_S, _SILENT_PERIODS = 2.0, 4


def topic_rate(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Messages come at the rate, in any few of them in a row.

    Raises:
        Failed: they come at another, or not at all; with topic.silent.
    """
    del around
    ensure_up(context, check.endpoints)
    topic = topic_of(check.endpoints["publisher"])
    inbox = context.grader_node.inbox(topic.interface, topic.name)
    period_s, off_by = 1.0 / check.keys["hz"], float(check.keys.get("tolerance", _OFF_BY))
    patience_s = max(_SILENT_S, _SILENT_PERIODS * period_s)
    evidence = Evidence("", f"a message on {topic.name} every {period_s:.3g} s")
    clock, count = context.clock(), max(_FEWEST, inbox.count)
    while await_next(context, inbox, count, patience_s, evidence):
        times = list(inbox.times)
        evidence = replace(evidence, got=f"one every {_period(times):.3g} s")
        if any(abs(_period(some) - period_s) <= off_by * period_s for some in _looks(times)):
            return evidence
        if clock.past(_PERIODS * period_s + _SILENT_S):
            break
        count = inbox.count + 1
    if inbox.count < _FEWEST:
        seconds = told(clock.fair(), check.deadline_s)
        got = f"{inbox.count} message{'s' * (inbox.count != 1)} within {seconds} s"
        message = f"{topic.name} has to be published {check.keys['hz']:g} times a second, by a timer."
        raise Failed(replace(evidence, got=got), message, "topic.silent")
    raise Failed(evidence, f"Publish {topic.name} from a timer with a period of {period_s:.3g} s.")


def _looks(times: Sequence[float]) -> list[Sequence[float]]:
    """All of the messages, and the last of them."""
    return [times, times[-max(_FEWEST + 1, len(times) // 2) :]]


def _period(times: Sequence[float]) -> float:
    return (times[-1] - times[0]) / (len(times) - 1)
