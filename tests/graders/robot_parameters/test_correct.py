"""The right program of exercise 3, however it comes; styles, mistakes and checks: tests/proof."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from tests.graders.robot_parameters.conftest import EXERCISE, ROOT, SOLUTION, not_passed
from tests.reading import read

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path


@pytest.fixture(scope="module")
def worker() -> Iterator[grading.Worker]:
    with grading.Worker() as running:
        yield running


@pytest.fixture
def grade_source(tmp_path: Path, worker: grading.Worker) -> Callable[..., grading.Report]:
    """Grades bytes or a text under a file name."""

    def run(source: str | bytes, name: str = "answer.py") -> grading.Report:
        path = tmp_path / name
        path.write_bytes(source if isinstance(source, bytes) else source.encode())
        return grading.grade(EXERCISE, path, worker=worker)

    return run


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
    starter = read(folder / f"{EXERCISE}.py", EXERCISE).source
    notebook = read(folder / f"{EXERCISE}.ipynb", EXERCISE).source
    definition = starter[starter.index("class VelocityLimiter") : starter.index("def main")].strip()
    assert definition in notebook
