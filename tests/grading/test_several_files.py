"""An exercise whose submission is several programs, a launch file and a parameter file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from tests import several_files
from tests.several_files import ID

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


@pytest.fixture
def grade(tmp_path: Path, worker: grading.Worker) -> Callable[[Path], grading.Report]:
    made = several_files.write(tmp_path / "exercises")
    return lambda path: grading.grade(ID, path, worker=worker, exercises=made.parent, seed=3)


def test_each_program_of_a_folder_is_started_by_its_name(tmp_path: Path, grade: Callable[..., grading.Report]) -> None:
    report = grade(several_files.write_files(tmp_path / "mine"))
    assert [check.status for check in report.checks] == ["passed"] * 2, report


def test_a_missing_file_and_one_that_is_no_python_cost_only_what_needs_them(
    tmp_path: Path, grade: Callable[..., grading.Report]
) -> None:
    report = grade(several_files.write_files(tmp_path / "mine", gate_py="def ("))
    assert [check.status for check in report.checks] == ["failed", "passed"]
    assert "line 1" in report.checks[0].message
    report = grade(several_files.write_files(tmp_path / "yours", guard_py=None))
    assert [check.status for check in report.checks] == ["passed", "failed"]
    assert "The file guard.py is missing" in report.checks[1].message
    assert report.submission.endswith("yours (missing: guard.py)")
