"""What scores more than a starter, or has a solution's shape, makes the release fail."""

from __future__ import annotations

import re
import shutil
from typing import TYPE_CHECKING

import nbformat
import pytest

from course_kit.authoring import leaks
from tests.course_copy import REPOSITORY, SOLUTION, TEMPERATURE

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = [pytest.mark.answers, pytest.mark.timeout(300)]


@pytest.fixture
def edition(tmp_path: Path) -> Path:
    """An edition with one exercise and little else."""
    for name in (f"exercises/{TEMPERATURE}", "notebooks/demos", "tests/lab"):
        shutil.copytree(REPOSITORY / name, tmp_path / name)
    return tmp_path


def find(edition: Path) -> list[tuple[str, str]]:
    return [(one.file, one.why) for one in leaks.find_leaks(edition, {TEMPERATURE: SOLUTION})]


def variant(name: str = "class_only") -> str:
    return (REPOSITORY / "tests/grading/correct" / TEMPERATURE / f"{name}.py").read_text()


def notebook_of(program: str) -> str:
    cell = nbformat.v4.new_code_cell(f"%%submission {TEMPERATURE}\n{program}")
    return nbformat.writes(nbformat.v4.new_notebook(cells=[cell]))


def test_right_programs_and_parts_of_the_solution_are_found(edition: Path) -> None:
    """A right program of another shape by its score; a solution with other names, or within a page, by its shape."""
    renamed = re.sub(r"\b(\w*[Tt]emp\w*|request|response|self)\b", r"\1_x", SOLUTION.read_text())
    (edition / "tests/lab/test_hidden.py").write_text(renamed)
    (edition / "notebooks/demos/NOTES.md").write_text(f"# So\n\n```python\n{SOLUTION.read_text()}```\n")
    (edition / "notebooks/demos/08_mine.ipynb").write_text(notebook_of(variant()))
    found = find(edition)
    for file, why in (
        ("tests/lab/test_hidden.py", r"has \d+% of the solution's own lines"),
        ("notebooks/demos/NOTES.md", r"has 100% of the solution's own lines"),
        ("notebooks/demos/08_mine.ipynb", r"scores [\d.]+ of 10, the starter 1"),
    ):
        assert [said for name, said in found if name == file and re.fullmatch(why, said)], (file, found)
