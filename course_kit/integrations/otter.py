"""`course-kit otter EXERCISE`: a test file for Otter-Grader, in which each check is a test case with its points."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse

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


def case_file(exercise_id: str, seed: int | None = None) -> str:
    """The text of the test file for an exercise; one that draws its questions has other checks with another seed."""
    from course_kit.grading.model.exercise import load_exercise
    from course_kit.grading.workers import exercise_job

    exercise = load_exercise(exercise_id)
    drawn = seed if seed is not None else exercise.seed or 0
    command, more = (exercise_id, "") if seed is None else (f"{exercise_id} --seed {seed}", f", seed={seed}")
    checks = exercise_job.checks_of(exercise, drawn)
    cases = [_CASE.format(check=check, exercise=exercise_id, more=more) for check in checks]
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
