"""Whatever a submission answers, it gets a verdict: an error of the grader comes from the grader or the machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring.corpus import ProofSubmission
from course_kit.authoring.gradings import Gradings
from course_kit.grading.model.exercise import load_exercise
from tests.graders.strange_programs import ANYTHING, PROGRAMS

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading import Report

pytestmark = [pytest.mark.answers, pytest.mark.timeout(1200)]


@pytest.fixture(scope="module")
def graded(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Report]:
    """All of them, side by side."""
    folder: Path = tmp_path_factory.mktemp("strange")
    with Gradings([load_exercise(name) for name in {one.exercise for one in PROGRAMS.values()}]) as pool:
        requests = []
        for number, (name, program) in enumerate(PROGRAMS.items()):
            path = folder / f"answer_{number}.py"
            path.write_text(program.text())
            submission = ProofSubmission(program.exercise, "strange", name, path)
            requests.append((name, pool.request_for(submission, 3)))
        return dict(pool.grade_all(requests))


@pytest.mark.parametrize("name", PROGRAMS)
def test_it_gets_a_verdict(name: str, graded: dict[str, Report]) -> None:
    report, first = graded[name], PROGRAMS[name].first
    assert report.status in ("graded", "crashed"), report.problem
    if first != ANYTHING:
        assert next((one.id, one.diagnosis) for one in report.checks if one.status == "failed") == first
