"""What scores more than a starter, or has a solution's shape, makes the release fail."""

from __future__ import annotations

import re
import shutil
from typing import TYPE_CHECKING

import nbformat
import pytest

from course_kit.authoring import leaks
from tests import several_files
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


def test_of_several_files_a_solved_one_is_found_by_its_shape_and_by_what_it_scores(tmp_path: Path) -> None:
    made = several_files.write(tmp_path / "exercises")
    solution = (made / "solution").rename(tmp_path.parent / f"{tmp_path.name}-solution")
    to_do = dict.fromkeys(("gate_py", "guard_py", "pair_launch_py", "pair_yaml"), "# Your code goes here.\n")
    several_files.write_files(made, **to_do)
    (made / f"{several_files.ID}.ipynb").write_text(several_files.notebook(**to_do))
    assert leaks.find_leaks(tmp_path, {several_files.ID: solution}) == []
    (tmp_path / "NOTES.md").write_text(f"```python\n{several_files.FILES['gate.py']}```\n")
    shutil.copytree(made, tmp_path / "mine")
    shutil.copy(solution / "gate.py", tmp_path / "mine/gate.py")
    (tmp_path / "mine.ipynb").write_text(several_files.notebook(pair_launch_py=None))
    found = {(leak.file, leak.why) for leak in leaks.find_leaks(tmp_path, {several_files.ID: solution})}
    assert {
        ("NOTES.md", "has 100% of the solution's own lines"),
        ("mine/gate.py", "has 100% of the solution's own lines"),
        ("mine", "scores 2 of 5, the starter 0"),
        ("mine.ipynb", "scores 3 of 5, the starter 0"),
    } <= found
    assert not [file for file, _ in found if file.startswith("exercises")]
