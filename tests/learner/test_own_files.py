"""An exercise of several files: which of them `grade` takes, and what `reset` and `solution` do."""

from __future__ import annotations

import json
import os
import shutil
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.grading import GradingError
from course_kit.grading.model.exercise import load_exercise
from course_kit.learner import handouts, workspace
from tests import several_files
from tests.course_copy import REPOSITORY, Course

if TYPE_CHECKING:
    from pathlib import Path

ID = "delivery_robot"
EXERCISE = load_exercise(ID)
MINE = "# mine\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = tmp_path / "student"
    made.mkdir()
    for name in EXERCISE.starters:
        shutil.copy(EXERCISE.folder / name, made / name)
        os.utime(made / name, (1e9, 1e9))
    monkeypatch.chdir(made)
    return made


def begin(path: Path, *, after_s: int = 0) -> None:
    """Write something into a program, or into the cell of carrier.py."""
    if path.suffix == ".ipynb":
        notebook = json.loads(path.read_text())
        cell = next(cell for cell in notebook["cells"] if "".join(cell["source"]).startswith(f"%%submission {ID} carr"))
        cell["source"] = "".join(cell["source"]) + MINE + "DONE = True\n"
        path.write_text(json.dumps(notebook))
    else:
        path.write_text(path.read_text() + MINE + "DONE = True\n")
    os.utime(path, (1e9 + after_s, 1e9 + after_s))


@pytest.mark.parametrize(
    ("begun", "graded", "said"),
    [
        ([], ".", "grading ."),
        (["door.py"], ".", "because delivery_robot.ipynb is still the starter"),
        (["delivery_robot.ipynb"], "delivery_robot.ipynb", "because student is still the starter"),
        (["door.py", "delivery_robot.ipynb"], "delivery_robot.ipynb", f"For the other one: {{}} grade {ID} ."),
    ],
)
def test_without_a_path_the_folder_is_graded_or_the_notebook(
    folder: Path, begun: list[str], graded: str, said: str
) -> None:
    for after_s, name in enumerate(begun):
        begin(folder / name, after_s=3600 * after_s)
    path, sentence = workspace.choose_to_grade(ID, None)
    assert path == graded
    assert sentence.endswith(said.format(environment.course_command()))


def test_without_a_path_a_file_that_is_missing_is_named_in_the_report(tmp_path: Path) -> None:
    several_files.write_files(several_files.write(tmp_path / "course").parent / "mine", guard_py=None)
    mine = tmp_path / "course" / "mine"
    course = Course(tmp_path)
    done = course.run("grade", several_files.ID, str(mine), "--only", "guard", COURSE_EXERCISES=str(mine.parent))
    assert "The file guard.py is missing" in done.stdout, done.stdout + done.stderr


def test_reset_puts_back_what_was_changed_and_keeps_each_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    begin(folder / "door.py")
    begin(folder / "delivery.launch.py")
    (folder / "robot.yaml").unlink()
    (folder / "helper.py").write_text(MINE)
    assert handouts.reset_exercise(ID, forget=False) == 0
    said = capsys.readouterr().out
    for name in EXERCISE.files:
        assert (folder / name).read_bytes() == (EXERCISE.folder / name).read_bytes(), name
    assert MINE in (folder / "door.backup-1.py").read_text()
    assert MINE in (folder / "delivery.launch.backup-1.py").read_text()
    assert (folder / "helper.py").read_text() == MINE
    assert "carrier.py" not in said
    assert len(list(folder.glob("*.backup-*"))) == 2


def test_reset_of_one_file_is_of_that_file(folder: Path) -> None:
    for name in ("carrier.py", "door.py"):
        begin(folder / name)
    assert handouts.reset_exercise(ID, forget=False, place=folder / "carrier.py") == 0
    assert (folder / "carrier.py").read_bytes() == (EXERCISE.folder / "carrier.py").read_bytes()
    assert MINE in (folder / "door.py").read_text()
    with pytest.raises(GradingError, match=r"is not one of the files of delivery_robot: battery\.py, door\.py"):
        handouts.reset_exercise(ID, forget=False, place=folder / "motor.py")


@pytest.mark.answers
def test_the_solution_shows_each_file_once_it_was_earned(tmp_path: Path) -> None:
    course = Course(tmp_path)
    closed = course.run("solution", ID)
    assert (closed.returncode, closed.stdout) == (1, "")
    assert "with 18 of 30 points" in closed.stderr
    record = {"best": 20.0, "tries": 1, "first_passed": "2026-11-21T12:00:00+00:00"}
    course.progress.write_text(json.dumps({"format_version": 1, "exercises": {ID: record}}))
    opened = course.run("solution", ID)
    assert opened.returncode == 0, opened.stderr
    for name in EXERCISE.files:
        assert f"# --- {name}\n{(REPOSITORY / 'solutions' / ID / name).read_text()}" in opened.stdout
