"""Where things are kept, and how the user calls the course."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.environment import paths

SCRIPTS = str(Path(sys.prefix) / "bin")


def test_the_course_is_called_by_its_door_where_that_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    root = environment.checkout_folder()
    assert root is not None
    monkeypatch.chdir(root)
    assert environment.course_command() == "./course"
    monkeypatch.chdir(tmp_path)
    assert environment.course_command() == "course-kit"
    (tmp_path / "course").touch()
    assert environment.course_command() == "course-kit"
    (tmp_path / "course").unlink()
    (tmp_path / "course").symlink_to(root / "course")  # as in a learner's own copy
    assert environment.course_command() == "./course"
    (tmp_path / "course").unlink()
    tmp_path.rmdir()
    assert environment.course_command() == "course-kit"


def test_a_home_is_one_that_can_be_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert environment.paths.home_folder() == tmp_path
    for none in ("/proc/nonexistent", "/proc/self", "relative"):
        monkeypatch.setenv("HOME", none)
        assert environment.paths.home_folder() is None


def test_where_nobody_knows_the_home_the_state_is_among_the_temporary_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unknown(*_: object, **__: object) -> Path:
        raise RuntimeError("could not determine the home directory")

    monkeypatch.setattr("platformdirs.user_state_path", unknown)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("HOME", "/nobody knows it")  # the folder is kept by this name
    assert environment.state_dir().is_relative_to(tmp_path)
    assert environment.paths.usual_state_dir() is None


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("/usr/bin:/bin", f"{SCRIPTS}:/usr/bin:/bin"),
        (f"/opt/ros/jazzy/bin:{SCRIPTS}:/bin", f"{SCRIPTS}:/opt/ros/jazzy/bin:/bin"),
        (f"{SCRIPTS}:/bin", f"{SCRIPTS}:/bin"),
        (None, f"{SCRIPTS}:/bin:/usr/bin"),
    ],
)
def test_they_come_first_and_the_others_stay_in_their_order(before: str | None, after: str) -> None:
    assert paths.with_scripts_first(before) == after
