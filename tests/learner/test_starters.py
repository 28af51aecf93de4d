"""`reset` and `solution` in a copy of the course: the starter comes back, and no work is ever lost."""

from __future__ import annotations

import json
import os
import shutil
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.grading import GradingError
from course_kit.learner import handouts, workspace
from tests.course_copy import SOLUTION, TEMPERATURE, Course, copy_course

if TYPE_CHECKING:
    from pathlib import Path

PASSED = {"best": 8.0, "tries": 3, "first_passed": "2026-11-21T12:00:00+00:00"}
MINE = "print('my work')\n"


@pytest.fixture(scope="module")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Course:
    return copy_course(tmp_path_factory.mktemp("student"))


@pytest.fixture
def course(pristine: Course, tmp_path: Path) -> Course:
    """The copy, with a learner's folder as at the beginning."""
    shutil.rmtree(pristine.root / environment.LEARNER_FOLDER, ignore_errors=True)
    workspace.make_copy(pristine.root, pristine.root / environment.LEARNER_FOLDER)
    return Course(tmp_path, pristine.root)


@pytest.fixture
def file(course: Course) -> Path:
    return course.root / environment.LEARNER_FOLDER / "exercises" / TEMPERATURE / f"{TEMPERATURE}.py"


def keep(course: Course, **entry: object) -> None:
    course.progress.write_text(json.dumps({"format_version": 1, "exercises": {TEMPERATURE: entry}}))


def test_an_untouched_exercise_is_left_alone(course: Course, file: Path) -> None:
    before = sorted(file.parent.iterdir())
    done = course.run("reset", TEMPERATURE)
    assert done.returncode == 0
    assert "already matches the starter" in done.stdout
    assert sorted(file.parent.iterdir()) == before


def test_the_starter_comes_back_and_each_version_is_kept_beside_it(course: Course, file: Path) -> None:
    starter = file.read_bytes()
    for number in (1, 2):
        file.write_text(MINE * number)
        done = course.run("reset", TEMPERATURE)
        assert done.returncode == 0, done.stderr
        assert f"{TEMPERATURE}.backup-{number}.py" in done.stdout
        assert file.read_bytes() == starter
    assert file.with_name(f"{TEMPERATURE}.backup-1.py").read_text() == MINE
    assert file.with_name(f"{TEMPERATURE}.backup-2.py").read_text() == MINE * 2
    assert not [path for path in file.parent.iterdir() if path.name.endswith(".ipynb") and "backup" in path.name]


def test_a_file_that_was_removed_comes_back(course: Course, file: Path) -> None:
    notebook = file.with_suffix(".ipynb")
    starter = notebook.read_bytes()
    notebook.unlink()
    assert course.run("reset", TEMPERATURE).returncode == 0
    assert notebook.read_bytes() == starter
    assert not list(file.parent.glob("*.backup-*"))


def test_a_backup_that_cannot_be_written_leaves_the_file(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    file.write_text(MINE)
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(GradingError, match="No space left"):
        handouts.reset_exercise(TEMPERATURE, forget=False, place=file)
    assert file.read_text() == MINE


def test_the_student_edition_says_that_it_has_no_solutions(course: Course) -> None:
    keep(course, **PASSED)
    done = course.run("solution", TEMPERATURE)
    assert done.returncode == 2
    assert "without solutions" in done.stderr


@pytest.mark.answers
def test_the_solution_opens_with_a_pass(tmp_path: Path) -> None:
    course = Course(tmp_path)
    closed = course.run("solution", TEMPERATURE)
    assert (closed.returncode, closed.stdout) == (1, "")
    assert "7 of 10 points" in closed.stderr
    keep(course, best=6.5, tries=2)
    closed = course.run("solution", TEMPERATURE)
    assert (closed.returncode, closed.stdout) == (1, "")
    assert "your best so far is 6.5" in closed.stderr
    assert course.run("solution", TEMPERATURE, "--show").stdout == SOLUTION.read_text()
    keep(course, **PASSED)
    opened = course.run("solution", TEMPERATURE)
    assert (opened.returncode, opened.stdout) == (0, SOLUTION.read_text())
