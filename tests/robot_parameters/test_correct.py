"""Programs that are right, whatever their style, get full marks."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from course_kit.grading import submission
from tests.robot_parameters.conftest import EXERCISE, ROOT, SOLUTION, Reports, not_passed

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CORRECT = sorted((ROOT / "tests" / "grading" / "correct" / EXERCISE).glob("*.py"))
STARTER = ROOT / "exercises" / EXERCISE / f"{EXERCISE}.py"


def test_there_are_at_least_eight_styles() -> None:
    assert len(CORRECT) >= 8


@pytest.mark.parametrize("program", [SOLUTION, *CORRECT], ids=lambda path: path.stem)
def test_correct_program_gets_full_marks(program: Path, reports: Reports) -> None:
    report = reports.of(program)
    assert not_passed(report) == []
    assert (report.status, report.score, report.max_score, report.passed) == ("graded", 20.0, 20.0, True)
    assert sum(check.max_points for check in report.checks) == report.max_score


@pytest.mark.parametrize("program", [STARTER], ids=["starter"])
def test_starter_fails_with_a_useful_first_hint(program: Path, reports: Reports) -> None:
    report = reports.of(program)
    first = next(check for check in report.checks if check.status == "failed")
    assert grading.exit_code(report) == 1
    assert (first.id, first.diagnosis) == ("declared", "parameter.undeclared")
    assert "robot_name and max_velocity and wheel_diameter and enabled" in first.message
    assert first.hint is not None
    assert "declare_parameter(name, default)" in first.hint


def test_windows_line_ends_and_byte_order_mark(grade_source: Callable[..., grading.Report]) -> None:
    data = b"\xef\xbb\xbf" + SOLUTION.read_text().replace("\n", "\r\n").encode()
    assert not_passed(grade_source(data)) == []


def test_notebook(grade_source: Callable[..., grading.Report]) -> None:
    head, _, rest = SOLUTION.read_text().partition("STATUS_PERIOD =")
    cells = [
        {"cell_type": "code", "source": [f"%%submission {EXERCISE}\n", *head.splitlines(keepends=True)]},
        {"cell_type": "code", "source": "raise SystemExit('not part of it')"},
        {"cell_type": "code", "source": f"%%submission {EXERCISE}\nSTATUS_PERIOD ={rest}"},
    ]
    assert not_passed(grade_source(json.dumps({"cells": cells}), "answer.ipynb")) == []


def test_starter_notebook_holds_the_class_of_the_starter() -> None:
    folder = ROOT / "exercises" / EXERCISE
    starter = submission.read(folder / f"{EXERCISE}.py", EXERCISE).source
    notebook = submission.read(folder / f"{EXERCISE}.ipynb", EXERCISE).source
    definition = starter[starter.index("class VelocityLimiter") : starter.index("def main")].strip()
    assert definition in notebook
