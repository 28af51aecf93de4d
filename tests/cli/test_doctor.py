"""`course-kit doctor` on this machine, and on the same machine with something wrong."""

from __future__ import annotations

import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.cli import doctor as command
from tests.course_copy import REPOSITORY, Course, copy_course
from tests.environment.overwritten import overwrite_lark
from tests.unprivileged import as_somebody, forbid_writing

if TYPE_CHECKING:
    from pathlib import Path


def doctor(**changes: str | None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "course_kit", "doctor"],
        env=environment.child_environment(**changes), capture_output=True, text=True, timeout=100, check=False,
    )  # fmt: skip


def test_it_loads_nothing_from_the_folder_that_one_is_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A learner's, or strangers' submissions; each test of an installation is a Python of its own."""
    for name in ("rclpy", "example_interfaces", "json", "sitecustomize"):
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'sprung')!r}, 'a').write({name!r})\n")
    monkeypatch.chdir(tmp_path)
    assert command.check_interfaces().verdict == "ok"
    assert command.seconds_to_discover() is not None
    assert not (tmp_path / "sprung").exists()


@pytest.mark.parametrize(
    ("version", "verdict", "advice"),
    [
        ("7.1.6", "ok", ""),
        ("7.1.8", "ok", ""),
        ("7.1.9", "note", "goal_handle.succeed(result)"),
        ("7.1.10", "ok", ""),
        ("7.1.12", "ok", ""),
        ("9.1.2", "note", "jazzy_kilted_lyrical.md"),
        ("of unknown version", "ok", ""),
    ],
)
def test_a_version_of_rclpy_that_loses_results_is_named(
    version: str, verdict: str, advice: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command.importlib.metadata, "version", lambda _: version)
    found = command.rclpy_itself()
    assert (found.verdict, version in found.found) == (verdict, True)
    assert advice in found.advice


def line_about(subject: str, output: str) -> str:
    return next(line for line in output.splitlines() if line[6:].startswith(subject))


def test_a_working_installation_is_found_in_order_with_a_verdict_on_each_line() -> None:
    done = doctor()
    assert done.returncode == 0, done.stdout
    for subject in (
        "Python",
        "packages",
        "course folder",
        "your files",
        "ROS graph",
        "rclpy",
        "inside rclpy",
        "RMW",
        "Jupyter",
        "message types",
        "discovery",
    ):
        assert line_about(subject, done.stdout).startswith("ok"), done.stdout
    assert line_about("grader isolation", done.stdout)[:4] in ("ok  ", "note")
    assert done.stdout.endswith("The course has everything it needs.\n")
    assert done.stderr == ""
    assert max(map(len, done.stdout.splitlines())) <= 80


@pytest.mark.parametrize(
    ("changes", "subject", "advice"),
    [
        ({"ROS_DOMAIN_ID": "abc"}, "ROS graph", "a whole number from 0 to 232"),
        ({"COURSE_KIT_AUTOLOAD": "0"}, "message types", "run ./course lab"),
    ],
)
def test_what_is_wrong_is_named_with_what_to_do(changes: dict[str, str], subject: str, advice: str) -> None:
    done = doctor(**changes)
    assert done.returncode == 1
    assert line_about(subject, done.stdout).startswith("BAD")
    assert advice in " ".join(done.stdout.split())
    assert "Traceback" not in done.stdout + done.stderr


def test_a_package_that_another_has_overwritten_is_named_with_the_command_that_mends_it(tmp_path: Path) -> None:
    overwrite_lark(tmp_path)
    done = doctor(PYTHONPATH=str(tmp_path))
    assert done.returncode == 1
    assert line_about("packages", done.stdout).startswith("BAD   packages          lark-parser has overwritten files")
    assert "--no-deps lark==1.3.1" in " ".join(done.stdout.split())


def test_a_middleware_that_is_not_installed_is_noted_and_the_course_works() -> None:
    done = doctor(RMW_IMPLEMENTATION="rmw_of_nobody")
    assert done.returncode == 0, done.stdout
    assert line_about("RMW", done.stdout).startswith("note")
    assert "because RMW_IMPLEMENTATION=rmw_of_nobody is not installed" in " ".join(done.stdout.split())
    assert len(done.stderr.splitlines()) == 1


def test_a_course_that_this_user_may_not_write_is_noted(tmp_path: Path) -> None:
    course = copy_course(tmp_path)
    forbid_writing(course.root)
    try:
        done = somebodys_doctor(course, tmp_path)
    finally:
        forbid_writing(course.root, forbid=False)
    assert line_about("course folder", done.stdout).startswith("note")
    said = " ".join(done.stdout.split())
    assert "read-only for you" in said
    assert "lab opens your own copy" in said


def test_without_the_notebooks_it_says_what_works_and_what_is_missing(tmp_path: Path) -> None:
    """As with a wheel: the package alone, in a folder that is no course."""
    leave = shutil.ignore_patterns("__pycache__")
    shutil.copytree(REPOSITORY / "course_kit", tmp_path / "site" / "course_kit", ignore=leave)
    done = somebodys_doctor(Course(tmp_path, tmp_path / "site"), tmp_path)
    assert done.returncode == 1
    assert line_about("course folder", done.stdout).startswith("BAD")
    said = " ".join(done.stdout.split())
    assert "the lessons and exercises are missing" in said
    assert "Live nodes, panels, message types and ros2 work" in said
    assert line_about("discovery", done.stdout).startswith("ok")
    assert "The course has everything it needs" not in said


def somebodys_doctor(course: Course, home: Path) -> subprocess.CompletedProcess[str]:
    """As of a user without rights."""
    return subprocess.run(
        as_somebody(*course.command("doctor")), cwd=course.root, env=course.environ(HOME=str(home)),
        capture_output=True, text=True, timeout=100, check=False,
    )  # fmt: skip
