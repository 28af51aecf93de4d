"""Exercises outside of the course's folder: how they are found, and what is said where something is wrong with them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.cli.main import main
from course_kit.grading import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import list_exercise_ids, load_exercise, read_exercise
from tests import outside_exercises
from tests.outside_exercises import ID

OWN = (environment.checkout_folder() or Path()) / "exercises"


@pytest.fixture(autouse=True)
def _nothing_added(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(exercise_folders.VARIABLE, "")


def course_kit(*words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "course_kit", *words]
    return subprocess.run(
        command, env={**os.environ, **variables}, capture_output=True, text=True, timeout=200, check=False
    )


def test_a_folder_of_exercises_and_one_exercise_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    several, one = tmp_path / "several", tmp_path / "one"
    outside_exercises.write(several, "first")
    outside_exercises.write(several, "second")
    (several / "notes").mkdir()
    alone = outside_exercises.write(one)
    monkeypatch.setenv(exercise_folders.VARIABLE, os.pathsep.join(map(str, (several, alone))))
    assert {"first", "second", ID} == set(list_exercise_ids()) - set(list_exercise_ids(OWN))
    assert load_exercise("first").folder == several / "first"
    assert load_exercise(ID).grader == str(alone / "checks.py")


def test_two_exercises_of_one_id_are_named_with_both_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    places = [outside_exercises.write(tmp_path / name) for name in ("here", "there")]
    monkeypatch.setenv(exercise_folders.VARIABLE, os.pathsep.join(str(one.parent) for one in places))
    with pytest.raises(GradingError) as told:
        load_exercise(ID)
    assert all(str(one) in str(told.value) for one in places)
    assert load_exercise("temperature_service").folder.parent == OWN


def test_an_exercise_called_like_one_of_the_course_replaces_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine = outside_exercises.write(tmp_path, "temperature_service")
    monkeypatch.setenv(exercise_folders.VARIABLE, str(tmp_path))
    with pytest.raises(GradingError) as told:
        load_exercise("temperature_service")
    assert str(mine) in str(told.value)
    assert str(OWN / "temperature_service") in str(told.value)


def test_list_tells_of_every_problem_and_shows_the_rest(tmp_path: Path) -> None:
    broken = outside_exercises.write(tmp_path, "broken")
    (broken / "exercise.toml").write_text("title = \n")
    outside_exercises.write(tmp_path)
    named = [str(tmp_path), str(tmp_path / "gone"), "relative"]
    done = course_kit("list", COURSE_EXERCISES=os.pathsep.join(named))
    assert done.returncode == 0
    assert ID in done.stdout
    assert "temperature_service" in done.stdout
    said = done.stderr.splitlines()
    assert any(str(broken / "exercise.toml") in line and "line 1" in line for line in said)
    assert any(f"There is no folder {tmp_path / 'gone'}, which COURSE_EXERCISES names." in line for line in said)
    assert any("relative" in line and "whole path" in line for line in said)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [([], "There is no folder"), (["it"], "There is no exercise in"), (["it", "it/notes"], "There is no exercise in")],
)
def test_a_folder_without_exercises_is_refused(
    make: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in make:
        (tmp_path / name).mkdir()
    assert main(["list", "--exercises", str(tmp_path / "it")]) == 2
    assert sentence in capsys.readouterr().err


def test_an_unknown_exercise_names_the_added_ones_and_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outside_exercises.write(tmp_path)
    monkeypatch.setenv(exercise_folders.VARIABLE, os.pathsep.join([str(tmp_path), str(tmp_path / "gone")]))
    with pytest.raises(GradingError, match=f"Did you mean '?{ID}'?.*There is no folder.*gone"):
        load_exercise("add_thre")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('grader = "checks.py"', 'grader = "missing.py"', "the grader missing.py is not there"),
        ('grader = "checks.py"', 'grader = "../other.py"', "other.py lies outside"),
        ('grader = "checks.py"', 'grader = "my_graders.three"', "my_graders.three is no .py file in"),
        ('solution = "solution/add_three.py"', 'solution = "../other.py"', "other.py lies outside"),
        ('grader = "checks.py"', "", "'grader' is missing"),
        ('grader = "checks.py"', "grader = 3", "'grader' cannot be right: expected str, got int"),
    ],
)
def test_grader_and_solution_lie_in_the_folder_of_their_exercise(
    old: str, new: str, sentence: str, tmp_path: Path
) -> None:
    made = outside_exercises.write(tmp_path)
    (tmp_path / "other.py").write_text("")
    toml = made / "exercise.toml"
    toml.write_text(toml.read_text().replace(old, new))
    with pytest.raises(GradingError, match=sentence):
        read_exercise(made)
