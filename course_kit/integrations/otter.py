"""For courses that run on Otter-Grader: each check of an exercise as a test case of Otter, with its points.

All test cases of a notebook read one grading. `course-kit otter EXERCISE` prints the test file.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.text.console import WIDTH

if TYPE_CHECKING:
    import argparse

    from course_kit.grading import Report

_HEAD = """\
# Made by: course-kit otter {command}
from course_kit.otter import check
from otter.test_files import test_case

OK_FORMAT = False
name = {name!r}
"""
_CASE = """

@test_case(name={check.title!r}, points={check.points!r})
def test_{check.id}():
    check({exercise!r}, {check.id!r}{more})
"""


def check(exercise: str, name: str, *, seed: int | None = None) -> None:
    """Return when this notebook's submission passes a check of the exercise, and raise when it does not."""
    from course_kit.integrations.grade_magics import magics_of_notebook, nothing_from

    report = magics_of_notebook("otter.check").report(exercise, seed)
    if report is None:
        raise AssertionError(nothing_from(exercise))
    if text := feedback(report, name):
        raise AssertionError(text)


def feedback(report: Report, name: str) -> str:
    """What to tell about a check; empty when it was passed."""
    from course_kit.grading.render.text import check_lines

    if report.status == "error":
        raise GradingError(f"{report.problem} This is not the submission's fault: grade it again.")
    if report.status == "unreadable":
        return report.problem
    found = next((check for check in report.checks if check.id == name), None)
    if found is None:
        known = ", ".join(check.id for check in report.checks)
        raise GradingError(f"There is no check '{name}' in {report.exercise}. Its checks: {known}.")
    return "" if found.status == "passed" else "\n".join(check_lines(found, WIDTH))


def case_file(exercise_id: str, seed: int | None = None) -> str:
    """The text of the test file for an exercise; one that draws its questions has other checks with another seed."""
    from course_kit.grading.checks.check import in_order
    from course_kit.grading.model.exercise import load_exercise
    from course_kit.grading.workers import exercise_job

    exercise = load_exercise(exercise_id)
    drawn = seed if seed is not None else exercise.seed or 0
    command, more = (exercise_id, "") if seed is None else (f"{exercise_id} --seed {seed}", f", seed={seed}")
    cases = [
        _CASE.format(check=check, exercise=exercise_id, more=more)
        for check in in_order(exercise_job.checks_of(exercise, drawn))
    ]
    return "".join([_HEAD.format(command=command, name=exercise_id), *cases])


def add_to(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser("otter", help="print an exercise's test file for Otter-Grader, one case for each check")
    parser.add_argument("exercise", help="the exercise's id")
    parser.add_argument(
        "--seed", type=int, help="seed for the random values, and for the questions if the exercise has any"
    )
    parser.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    sys.stdout.write(case_file(options.exercise, options.seed))
    return 0
