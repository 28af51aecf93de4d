"""What the points of exercise 3 are for: a third of them is about values that a node refuses."""

from __future__ import annotations

from course_kit import grading
from tests.graders.robot_parameters.conftest import EXERCISE, ROOT, not_passed


def test_a_program_that_refuses_nothing_does_not_pass() -> None:
    report = grading.grade(EXERCISE, ROOT / "tests" / "broken" / EXERCISE / "validation.missing.py")
    lost = {check for check, _, _, _ in not_passed(report)}
    assert (lost, report.score, report.passed) == ({"refuses", "reason", "atomic", "start_invalid"}, 13.5, False)


def test_a_program_that_refuses_without_a_reason_passes_without_full_marks() -> None:
    report = grading.grade(EXERCISE, ROOT / "tests" / "broken" / EXERCISE / "validation.no_reason.py")
    lost = {check for check, _, _, _ in not_passed(report)}
    assert (lost, report.score, report.passed) == ({"reason"}, 18.5, True)
