"""What the tests of exercise 3 share."""

from __future__ import annotations

from pathlib import Path

from course_kit import environment, grading

EXERCISE = "robot_parameters"
ROOT = environment.checkout_folder() or Path()
SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"


def not_passed(report: grading.Report) -> list[tuple[str, str, str | None, str]]:
    return [(check.id, check.status, check.diagnosis, check.message) for check in report.checks if check.points == 0]
