"""Which of a learner's two files `grade` and `watch` mean: the one with the answer, as in a class run."""

from __future__ import annotations

import json
import os
import shutil
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.classroom.intake import collecting
from course_kit.grading.model.exercise import load_exercise
from course_kit.learner import workspace
from tests.course_copy import REPOSITORY, TEMPERATURE

if TYPE_CHECKING:
    from pathlib import Path

NOTEBOOK, PROGRAM = f"{TEMPERATURE}.ipynb", f"{TEMPERATURE}.py"
TODO, ANSWER = "# Your code goes here.", "response.success = True"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = tmp_path / "student"
    made.mkdir()
    for name in (NOTEBOOK, PROGRAM):
        shutil.copy(REPOSITORY / "exercises" / TEMPERATURE / name, made / name)
        os.utime(made / name, (1e9, 1e9))
    monkeypatch.chdir(made)
    return made


def answer(path: Path, *, after_s: int = 0) -> None:
    text = path.read_text(encoding="utf-8")
    assert TODO in text
    path.write_text(text.replace(TODO, ANSWER), encoding="utf-8")
    os.utime(path, (1e9 + after_s, 1e9 + after_s))


def by_class(folder: Path, workspace_folder: Path) -> str:
    exercise = load_exercise(TEMPERATURE)
    (entry,) = collecting.collect_submissions(folder.parent, [exercise], workspace_folder, "folders").entries
    return entry.source.rpartition("/")[2]


@pytest.mark.parametrize(
    ("answered", "graded", "said"),
    [
        ({NOTEBOOK: 0}, NOTEBOOK, f"because {PROGRAM} is still the starter"),
        ({PROGRAM: 0}, PROGRAM, f"because {NOTEBOOK} is still the starter"),
        ({PROGRAM: 0, NOTEBOOK: 3600}, NOTEBOOK, f"the newer of your two answers. For the other one: {{}} {PROGRAM}"),
        ({PROGRAM: 3600, NOTEBOOK: 0}, PROGRAM, f"the newer of your two answers. For the other one: {{}} {NOTEBOOK}"),
        ({}, PROGRAM, f"grading {PROGRAM}"),
    ],
)
def test_it_is_the_one_that_a_class_run_grades_and_it_is_named(
    folder: Path, tmp_path: Path, answered: dict[str, int], graded: str, said: str
) -> None:
    for name, after_s in answered.items():
        answer(folder / name, after_s=after_s)
    path, sentence = workspace.choose_to_grade(TEMPERATURE, None)
    assert path == graded == by_class(folder, tmp_path / "unpacked")
    assert sentence.endswith(said.format(f"{environment.course_command()} grade {TEMPERATURE}"))


def test_a_program_without_the_class_is_not_graded_in_place_of_a_notebook_that_has_it(folder: Path) -> None:
    answer(folder / NOTEBOOK)
    (folder / PROGRAM).write_text("print('a try')\n")
    path, sentence = workspace.choose_to_grade(TEMPERATURE, None)
    assert (path, sentence.partition("because ")[2]) == (NOTEBOOK, f"{PROGRAM} does not contain TemperatureService")


def test_a_notebook_that_was_only_run_is_the_starter_still(folder: Path) -> None:
    notebook = json.loads((folder / NOTEBOOK).read_text(encoding="utf-8"))
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] == "code":
            cell.update(execution_count=number, outputs=[])
    (folder / NOTEBOOK).write_text(json.dumps(notebook), encoding="utf-8")
    answer(folder / PROGRAM)
    assert workspace.choose_to_grade(TEMPERATURE, None)[0] == PROGRAM


def test_watch_means_the_same_file(folder: Path) -> None:
    answer(folder / NOTEBOOK)
    assert workspace.choose_own(load_exercise(TEMPERATURE), "watch")[0] == folder / NOTEBOOK
