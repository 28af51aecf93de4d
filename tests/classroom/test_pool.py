"""Workers of a class that are hurt from outside: whoever was graded there is graded by another one."""

from __future__ import annotations

import shutil
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.engine import GradingRequest
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.reading.file_copy import Copy
from course_kit.grading.reading.reader import Reader
from course_kit.grading.workers.pool import Pool

if TYPE_CHECKING:
    from course_kit.grading import Report

REPOSITORY = Path(__file__).resolve().parent.parent.parent
SERVICE = load_exercise("temperature_service")
SOLUTION = REPOSITORY / "solutions/temperature_service/temperature_service.py"

pytestmark = pytest.mark.answers


def grade(pool: Pool) -> Report:
    with Copy(SOLUTION) as copy, Reader() as reader:
        return pool.grade(GradingRequest(SERVICE, reader.read(copy, SERVICE), "jane.py", 7))


def test_a_worker_whose_folder_is_gone_costs_nobody_a_grade(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, domain: int
) -> None:
    """A cleaner of temporary files takes it, at the moment when the worker waits for the next submission."""
    assert domain
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    with closing(Pool(1, [SERVICE.grader])) as pool:
        assert grade(pool).score == 10
        [folder] = tmp_path.glob("course-kit-worker-*")
        shutil.rmtree(folder)
        report = grade(pool)
        assert (report.status, report.score) == ("graded", 10), report.problem
        assert grade(pool).score == 10
