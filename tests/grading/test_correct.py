"""The right program, however it comes: with foreign line ends, in a notebook, a second time. Styles: tests/proof."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from course_kit import grading
from tests.grading.conftest import EXERCISE, ROOT

if TYPE_CHECKING:
    from collections.abc import Callable


def failures(report: grading.Report) -> list[tuple[str, str, str]]:
    return [(check.id, check.status, check.message) for check in report.checks if check.status != "passed"]


def test_solution_gets_full_marks_in_a_worker_of_its_own() -> None:
    report = grading.grade(EXERCISE, ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py")
    assert failures(report) == []
    assert grading.exit_code(report) == 0


def test_notebook(grade_source: Callable[..., grading.Report], solution: str) -> None:
    imports, _, rest = solution.partition("CELSIUS =")
    cells = [
        {"cell_type": "markdown", "source": ["# Exercise\n"]},
        {"cell_type": "code", "source": [f"%%submission {EXERCISE}\n", *imports.splitlines(keepends=True)]},
        {"cell_type": "code", "source": "%matplotlib inline\nraise SystemExit('not part of it')"},
        {"cell_type": "code", "source": f"%%submission {EXERCISE}\nCELSIUS ={rest}"},
    ]
    report = grade_source(json.dumps({"cells": cells}), "answer.ipynb")
    assert failures(report) == []


def test_the_same_program_is_asked_the_same(grade_source: Callable[..., grading.Report], solution: str) -> None:
    reports = [grade_source(solution, seed=None) for _ in range(2)]
    asked, again = ((report.seed, [check.sent for check in report.checks]) for report in reports)
    assert asked == again
