"""What a grading has come to, as the supervisor tells it to the process that writes the report."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypedDict

if TYPE_CHECKING:
    from course_kit.grading.model.plain_data import Record


class GradingOutcome(TypedDict):
    """The outcome."""

    results: list[Record]  # of each check, as a record of `checks.check.Result`
    stdout: str  # first and last 4 kB of what the submission printed
    stderr: str  # the same of its errors
    problem: str  # why the grading came to no end; empty when it did
    timings: Record  # where the time went, see `Report.timings`
    again: bool  # whether it may go better the next time, because something was killed that should not be
