"""Whatever a submission answers, it gets a verdict: an error of the grader comes from the grader or the machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from tests.graders.strange_programs import ANYTHING, PROGRAMS

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.answers, pytest.mark.attack("Strange answers")]


@pytest.mark.parametrize("name", PROGRAMS)
def test_it_gets_a_verdict(name: str, worker: grading.Worker, tmp_path: Path) -> None:
    program = PROGRAMS[name]
    path = tmp_path / "answer.py"
    path.write_text(program.text())
    report = grading.grade(program.exercise, path, worker=worker, seed=3)
    assert report.status in ("graded", "crashed"), report.problem
    if program.first != ANYTHING:
        assert next((one.id, one.diagnosis) for one in report.checks if one.status == "failed") == program.first
