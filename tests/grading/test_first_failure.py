"""A grading that ends with the first failed check, for whoever only asks whether there is one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading import engine
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.reading import Reader, copy_file
from tests.grading.conftest import EXERCISE, ROOT

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading import Worker
    from course_kit.grading.model.report import Report

SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"


def graded(path: Path, worker: Worker, *, first_failure: bool) -> Report:
    exercise = load_exercise(EXERCISE)
    with Reader() as reader, copy_file(path) as copy:
        text = reader.read(copy, exercise)
    return engine.grade_submission(
        engine.GradingRequest(exercise, text, path.name, 1, first_failure=first_failure), worker
    )


def test_nothing_is_checked_after_the_first_failure(tmp_path: Path, worker: Worker) -> None:
    wrong = tmp_path / "wrong.py"
    converted = "from_celsius(to_celsius(request.value, request.from_unit), request.to_unit)"
    wrong.write_text(SOLUTION.read_text().replace(converted, f"{converted} + (request.from_unit == FAHRENHEIT)"))
    whole, short = (graded(wrong, worker, first_failure=first) for first in (False, True))
    assert [check.id for check in short.checks] == [check.id for check in whole.checks][: len(short.checks)]
    assert {check.status for check in short.checks[:-1]} <= {"passed", "skipped"}  # skipped: its talk was cut short
    assert short.checks[-1].id == "fahrenheit_to_celsius"
    assert short.checks[-1].status == "failed"
    assert len(short.checks) < len(whole.checks)
    assert (short.status, short.problem) == ("graded", "")


def test_a_right_program_is_checked_to_the_end(worker: Worker) -> None:
    report = graded(SOLUTION, worker, first_failure=True)
    assert report.score == report.max_score
    assert {check.status for check in report.checks} == {"passed"}
    assert all(isinstance(check.proves, tuple) for check in report.checks)
