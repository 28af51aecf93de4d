"""What test files for Otter-Grader import; all test cases of a notebook read one grading."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.grading.render.text import check_lines
from course_kit.integrations.grade_magics import magics_of_notebook, nothing_from
from course_kit.text.console import WIDTH

if TYPE_CHECKING:
    from course_kit.grading import Report

__all__ = ["check"]


def check(exercise: str, name: str, *, seed: int | None = None) -> None:
    """Return when this notebook's submission passes a check of the exercise, and raise when it does not."""
    report = magics_of_notebook("otter.check").report(exercise, seed)
    if report is None:
        raise AssertionError(nothing_from(exercise))
    if text := feedback(report, name):
        raise AssertionError(text)


def feedback(report: Report, name: str) -> str:
    """What to tell about a check; empty when it was passed."""
    if report.status == "error":
        raise GradingError(f"{report.problem} This is not the submission's fault: grade it again.")
    if report.status == "unreadable":
        return report.problem
    found = next((check for check in report.checks if check.id == name), None)
    if found is None:
        known = ", ".join(check.id for check in report.checks)
        raise GradingError(f"There is no check '{name}' in {report.exercise}. Its checks: {known}.")
    return "" if found.status == "passed" else "\n".join(check_lines(found, WIDTH))
