"""What stands in exercise.toml is what learners read in notebook and starter, word for word and in order."""

from __future__ import annotations

import ast
import json
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.authoring import corpus, new_exercise
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Sentence, load_exercise

if TYPE_CHECKING:
    from pathlib import Path

ROOT = environment.checkout_folder()
assert ROOT is not None
EXERCISES = corpus.all_exercises(ROOT)
FIRST, SECOND = Sentence("a", "A first.", heading="One."), Sentence("b", "A second.")
ROW, NEXT = Sentence("c", "| `x` | 1 |", heading="| name | value |"), Sentence("d", "| `longer` | |")


def words(text: str) -> list[str]:
    return text.split()


@pytest.mark.parametrize("name", EXERCISES)
def test_starter_carries_the_whole_task(name: str) -> None:
    exercise = load_exercise(name)
    told = set()
    for file in exercise.files or (exercise.starter,):
        if file.endswith(".py"):
            sentences = new_exercise.sentences_of(exercise, file)
            docstring = ast.get_docstring(ast.parse((exercise.folder / file).read_text())) or ""
            assert " ".join(words(new_exercise.format_sentences(sentences, width=100))) in " ".join(words(docstring))
            told.update(one.id for one in sentences)
    assert told == {one.id for one in exercise.sentences}


@pytest.mark.parametrize("name", EXERCISES)
def test_notebook_carries_the_whole_task_in_this_order(name: str) -> None:
    exercise = load_exercise(name)
    cells = json.loads((exercise.folder / exercise.notebook).read_text())["cells"]
    prose = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    places = [
        prose.index(new_exercise.format_sentences(told))
        for told in new_exercise.group_by_cell(exercise.sentences).values()
    ]
    assert places == sorted(places)


@pytest.mark.parametrize("name", EXERCISES)
def test_nothing_is_left_to_write(name: str) -> None:
    exercise = load_exercise(name)
    for file in (*(exercise.files or (exercise.starter,)), exercise.notebook):
        before = after = (exercise.folder / file).read_text()
        if file == exercise.notebook:
            after = new_exercise.fill_notebook(before, exercise)
        elif file.endswith(".py"):
            after = new_exercise.fill_starter(before, exercise, file)
        assert words(after) == words(before), f"run ./course new exercise {name} --refresh"


def test_sentences_become_a_list_with_bold_headings_and_tables() -> None:
    text = new_exercise.format_sentences([FIRST, SECOND, ROW, NEXT, Sentence("e", "An end.", heading="Last.")])
    assert text.splitlines() == [
        "- **One.** A first. A second.",
        "",
        "| name     | value |",
        "|----------|-------|",
        "| `x`      | 1     |",
        "| `longer` |       |",
        "",
        "- **Last.** An end.",
    ]


def test_a_change_of_a_sentence_reaches_notebook_and_starter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exercise_folders, "is_added", lambda _folder: False)
    folder = tmp_path / "temperature_service"
    folder.mkdir()
    for path in (ROOT / "exercises" / folder.name).iterdir():
        if path.is_file():
            (folder / path.name).write_bytes(path.read_bytes())
    toml = folder / "exercise.toml"
    toml.write_text(toml.read_text().replace("Any human language will do.", "Latin will do."))
    exercise = load_exercise(folder.name, tmp_path)
    assert new_exercise.refresh_exercise(exercise) == [folder / exercise.starter, folder / exercise.notebook]
    assert all("Latin will do." in path.read_text() for path in (folder / exercise.starter, folder / exercise.notebook))
    assert new_exercise.refresh_exercise(exercise) == []
