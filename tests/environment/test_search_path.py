"""PATH with the programs of the course first."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.environment import search_path

SCRIPTS = str(Path(sys.prefix) / "bin")


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
    assert search_path.with_scripts_first(before) == after


def test_children_of_the_course_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/usr/bin")
    assert environment.child_environment()["PATH"] == f"{SCRIPTS}:/usr/bin"
    assert environment.child_environment(PATH="/mine")["PATH"] == "/mine"


def test_with_a_users_installation_it_is_the_folder_at_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("prefix", "at home"):
        (tmp_path / name / "bin").mkdir(parents=True)
    (tmp_path / "at home" / "bin" / "ros2").touch()
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "prefix"))
    monkeypatch.setattr("site.getuserbase", lambda: str(tmp_path / "at home"))
    assert environment.scripts_folder() == tmp_path / "at home" / "bin"
    (tmp_path / "prefix" / "bin" / "ros2").touch()
    assert environment.scripts_folder() == tmp_path / "prefix" / "bin"
