"""Exercises of other folders in a student edition and in an autograder: they work there, and bring no answers."""

from __future__ import annotations

import shutil
import zipfile
from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import autograders
from tests import outside_exercises, several_files
from tests.course_copy import TEMPERATURE, Course
from tests.outside_exercises import ID

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

pytestmark = [pytest.mark.answers, pytest.mark.timeout(300)]  # each release has its own deadline in `Course.run`
CARRIED = {
    "add_three.ipynb", "add_three.py", "checks.py", "exercise.toml", "interfaces/three_interfaces/srv/Three.srv",
    "samples.py",
}  # fmt: skip


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    made = outside_exercises.write(tmp_path / "mine")
    for name in ("proof/broken/wrong.py", "old_solution.py", "notes/exam.md", "picture.png", "__pycache__/checks.pyc"):
        (made / name).parent.mkdir(parents=True, exist_ok=True)
        (made / name).write_text(outside_exercises.SOLUTION if name.endswith(".py") else "text")
    return made


def test_an_edition_carries_it_without_its_solution_and_students_are_graded(
    mine: Path, one_exercise: Callable[[str], Course], tmp_path: Path
) -> None:
    course = one_exercise(TEMPERATURE)
    edition = tmp_path / "student"
    done = course.run("release", str(edition), "--exercises", str(mine))
    assert done.returncode == 0, done.stderr
    assert f"Put in from another folder: {ID} ({mine})." in done.stdout
    folder = edition / "exercises" / ID
    found = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert found == {*CARRIED, "picture.png"}
    helper = "course_kit/interfaces/native/_helper.so"  # which `./course` compiles
    shutil.copy(course.root / helper, edition / helper)
    student = Course(tmp_path, edition)
    handed_in = tmp_path / "mine.py"
    handed_in.write_text(outside_exercises.SOLUTION)
    graded = student.run("grade", ID, str(handed_in))
    assert "3 of 3 points" in graded.stdout, graded.stdout + graded.stderr
    assert student.run("solution", ID).returncode == 2
    assert student.run("copy").returncode == 0
    own = edition / "my-course" / "exercises" / ID / "add_three.py"
    own.write_text("changed")
    assert student.run("reset", ID).returncode == 0
    assert own.read_text() == outside_exercises.STARTER


def test_an_edition_with_a_solved_starter_is_refused(
    mine: Path, one_exercise: Callable[[str], Course], tmp_path: Path
) -> None:
    (mine / "add_three.py").write_text(outside_exercises.SOLUTION)
    done = one_exercise(TEMPERATURE).run("release", str(tmp_path / "student"), "--exercises", str(mine))
    assert done.returncode == 1, done.stderr
    assert "exercises/add_three/add_three.py" in done.stderr
    assert not (tmp_path / "student").exists()


def test_an_autograder_has_it_where_the_kit_looks(mine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_EXERCISES", str(mine))
    with zipfile.ZipFile(autograders.write_gradescope(ID, tmp_path / "autograder.zip")) as archive:
        names = archive.namelist()
    below = f"ros2-course/exercises/{ID}/"
    assert {name.removeprefix(below) for name in names if name.startswith(below)} == {*CARRIED, "picture.png"}


def test_one_of_several_files_is_carried_with_all_that_learners_begin_with(
    one_exercise: Callable[[str], Course], tmp_path: Path
) -> None:
    made = several_files.write(tmp_path / "mine")
    to_do = dict.fromkeys(("gate_py", "guard_py", "pair_launch_py", "pair_yaml"), "# Your code goes here.\n")
    several_files.write_files(made, **to_do)
    (made / f"{several_files.ID}.ipynb").write_text(several_files.notebook(**to_do))
    course, edition = one_exercise(TEMPERATURE), tmp_path / "student"
    done = course.run("release", str(edition), "--exercises", str(made))
    assert done.returncode == 0, done.stderr
    folder = edition / "exercises" / several_files.ID
    found = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert found == {*several_files.FILES, f"{several_files.ID}.ipynb", "exercise.toml", "checks.py"}
    shutil.copy(course.root / "course_kit/interfaces/native/_helper.so", edition / "course_kit/interfaces/native")
    mine = several_files.write_files(tmp_path / "handed_in", guard_py=None)
    graded = Course(tmp_path, edition).run("grade", several_files.ID, str(mine))
    assert "2 of 5 points" in graded.stdout, graded.stdout + graded.stderr
    several_files.write_files(made, **{**to_do, "gate_py": several_files.FILES["gate.py"]})
    refused = course.run("release", str(tmp_path / "another"), "--exercises", str(made))
    assert refused.returncode == 1, refused.stderr
    assert f"exercises/{several_files.ID}/gate.py, for {several_files.ID}: the starter scores 2 of 5" in refused.stderr
