"""`course-kit drills`: lists them, begins one, and keeps them apart from the exercises that count."""

from __future__ import annotations

import io
import json
import shutil
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import load_exercise
from course_kit.learner import course_list, workspace
from course_kit.reader import text as reader
from tests.course_copy import REPOSITORY, Course, copy_course

if TYPE_CHECKING:
    from pathlib import Path

IDS = sorted(exercise_folders.find_exercises(REPOSITORY / "exercises").drills)
DRILL = "dark_lamp"
PASSED = {"best": 2.0, "tries": 1, "first_passed": "2026-11-22T12:00:00+00:00"}


@pytest.fixture(scope="module")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Course:
    return copy_course(tmp_path_factory.mktemp("student"))


@pytest.fixture
def course(pristine: Course, tmp_path: Path) -> Course:
    return Course(tmp_path, pristine.root)


def test_the_list_names_each_with_its_symptom_and_what_to_do_next(course: Course) -> None:
    listed = course.run("drills")
    assert listed.returncode == 0, listed.stderr
    for name in IDS:
        first = load_exercise(name).symptom.split()[0]
        assert name in listed.stdout
        assert first in listed.stdout
    assert "0 of 8 done." in listed.stdout
    assert "Next:" in listed.stdout
    assert listed.stdout.splitlines()[-1].endswith("drills empty_dashboard")
    assert max(map(len, listed.stdout.splitlines())) <= 80


def test_what_is_done_has_its_tick(course: Course) -> None:
    course.progress.write_text(json.dumps({"format_version": 1, "exercises": {"empty_dashboard": PASSED}}))
    listed = course.run("drills").stdout
    assert "[x] 1 empty_dashboard: done" in listed
    assert "1 of 8 done." in listed
    assert "Next: " in listed
    assert listed.rstrip().endswith("drills deaf_to_cancel")
    assert "[x] 1 empty_dashboard: done" in course.run("drills", PYTHONIOENCODING="ascii").stdout


def test_one_is_begun_with_its_files_and_the_commands_for_it(course: Course) -> None:
    begun = course.run("drills", DRILL)
    assert begun.returncode == 0, begun.stderr
    assert "Drill 6: The lamp stays dark" in begun.stdout
    for command in ("watch", "grade", "hint", "reset"):
        assert f"{command} {DRILL}" in begun.stdout
    assert f"exercises/drills/{DRILL}/{DRILL}.py" in begun.stdout


def test_a_program_that_is_gone_comes_back_and_one_that_was_begun_stays(course: Course) -> None:
    mine = course.root / environment.LEARNER_FOLDER
    workspace.make_copy(course.root, mine)
    folder = mine / "exercises" / "drills" / DRILL
    program, notebook = folder / f"{DRILL}.py", folder / f"{DRILL}.ipynb"
    program.unlink()
    notebook.write_text("mine")
    assert course.run("drills", DRILL).returncode == 0
    assert program.read_bytes() == (course.root / "exercises" / "drills" / DRILL / f"{DRILL}.py").read_bytes()
    assert notebook.read_text() == "mine"
    assert course.run("reset", DRILL).returncode == 0
    assert notebook.read_text() != "mine"
    assert (folder / f"{DRILL}.backup-1.ipynb").read_text() == "mine"


def test_a_drill_is_graded_hinted_and_recorded_like_an_exercise(course: Course) -> None:
    program = course.root / "exercises" / "drills" / DRILL / f"{DRILL}.py"
    graded = course.run("grade", DRILL, str(program))
    assert graded.returncode == 1, graded.stderr
    assert "Float32, expected std_msgs/msg/Float64" in " ".join(graded.stdout.split())
    assert "Hint 1 of" in course.run("hint", DRILL).stdout
    fixed = program.read_text().replace("Float32", "Float64")
    program.write_text(fixed)
    assert course.run("grade", DRILL, str(program)).returncode == 0
    assert f"[x] 6 {DRILL}: done" in course.run("drills").stdout


def test_a_copy_of_a_shared_course_has_the_drills_without_their_solutions(tmp_path: Path) -> None:
    workspace.make_copy(REPOSITORY, tmp_path / "mine")
    copied = tmp_path / "mine" / "exercises" / "drills" / DRILL
    assert {path.name for path in copied.iterdir()} == {"checks.py", "exercise.toml", f"{DRILL}.py", f"{DRILL}.ipynb"}


def test_drills_of_an_instructor_are_listed_and_no_exercises(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = tmp_path / "my_lamp"
    shutil.copytree(REPOSITORY / "exercises" / "drills" / DRILL, made)
    toml = (made / "exercise.toml").read_text()
    (made / "exercise.toml").write_text(toml.replace(f'id = "{DRILL}"', 'id = "my_lamp"'))
    monkeypatch.setenv(exercise_folders.VARIABLE, str(tmp_path))
    assert "my_lamp" in course_list.describe_drills()[0]
    assert "my_lamp" not in [row.exercise.id for row in course_list.list_rows()[0]]


def test_a_cell_that_also_runs_as_a_program_keeps_its_line_numbers() -> None:
    cell = "%%submission dark_lamp\n%%ros_script dark_lamp --ros-args\nimport rclpy\n"
    notebook = {"cells": [{"cell_type": "code", "source": cell}], "nbformat": 4, "nbformat_minor": 5, "metadata": {}}

    source, places = reader.read_program("n.ipynb", io.BytesIO(json.dumps(notebook).encode()), DRILL)
    assert source.split("\n")[:2] == ["", "import rclpy"]
    assert places[0][0] == "cell 1"
