"""What comes on /status: the line, and how often."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.graders._limiter import LimiterSettings, read_status, status_fits, status_line
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.diagnosis.exceptions import explained
from course_kit.grading.diagnosis.hangs import told

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.topic import Inbox

_SILENT_S = 2.0  # four periods


def expect_status(
    context: CheckContext, heard: Inbox, settings: LimiterSettings, *, was: str | None = None, sent: str = ""
) -> Evidence:
    """The next line tells these settings; or the one after it, as one may be on its way.

    Args:
        context: the check's.
        heard: what comes on /status.
        settings: what the parameters were set to.
        was: the line before the change.
        sent: what was done, in words.

    Raises:
        Failed: it does not; with topic.silent, or parameter.read_once when it is what it `was` before a change.
    """
    evidence = Evidence(sent, f"on /status: {status_line(settings)}")
    asked = time.time()
    for number in range(2):
        clock = context.clock()
        if not _await_after(context, heard, asked, number + 1, evidence):
            evidence = replace(evidence, got=f"nothing within {told(clock.fair(), _SILENT_S)} s")
            raise Failed(evidence, "/status has to be published twice a second, by a timer.", "topic.silent")
        line = str(heard.after(asked)[number].data)
        context.record.came(f"/status: {line!r}")
        evidence = replace(evidence, got=f"on /status: {line}")
        if status_fits(settings, line):
            return evidence
    if line == was:
        raise Failed(
            evidence, "Your node accepted the change, but /status is the same as before.", "parameter.read_once"
        )
    raise Failed(evidence, _what_is_wrong(settings, line))


def _await_after(context: CheckContext, heard: Inbox, moment: float, count: int, evidence: Evidence) -> bool:
    """Wait for so many lines from a moment on; older ones may still wait to be taken, a fast program has many."""
    with explained(context, evidence):
        return context.wait_until(lambda: len(heard.after(moment)) >= count, _SILENT_S)


def _what_is_wrong(settings: LimiterSettings, line: str) -> str:
    read = read_status(line)
    if read is None:
        return "The line has to have the form <name>: <max_velocity> m/s, with a number in place of <max_velocity>."
    if read[0] != settings.robot_name:
        return f"The line begins with {read[0]!r}; robot_name is {settings.robot_name!r}."
    return f"The line says {read[1]!r} m/s; max_velocity is {settings.max_velocity!r}, unrounded."
