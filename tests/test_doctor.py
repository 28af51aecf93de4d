"""`course-kit doctor` on this machine, and on the same machine with something wrong."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from tests.environment.overwritten import overwrite_lark

if TYPE_CHECKING:
    from pathlib import Path


def doctor(**changes: str | None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "course_kit", "doctor"],
        env=environment.child_environment(**changes), capture_output=True, text=True, timeout=100, check=False,
    )  # fmt: skip


def line_about(subject: str, output: str) -> str:
    return next(line for line in output.splitlines() if line[6:].startswith(subject))


def test_a_working_installation_is_found_in_order_with_a_verdict_on_each_line() -> None:
    done = doctor()
    assert done.returncode == 0, done.stdout
    for subject in (
        "Python",
        "packages",
        "ROS graph",
        "rclpy",
        "RMW",
        "Jupyter",
        "message types",
        "shared memory",
        "discovery",
    ):
        assert line_about(subject, done.stdout).startswith("ok"), done.stdout
    assert line_about("grader isolation", done.stdout)[:4] in ("ok  ", "note")
    assert done.stdout.endswith("Everything the course needs is here.\n")
    assert done.stderr == ""
    assert max(map(len, done.stdout.splitlines())) <= 80


@pytest.mark.parametrize(
    ("changes", "subject", "advice"),
    [
        ({"ROS_DOMAIN_ID": "abc"}, "ROS graph", "a whole number from 0 to 232"),
        ({"RMW_IMPLEMENTATION": "rmw_of_nobody"}, "rclpy", "unset RMW_IMPLEMENTATION"),
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


def test_a_setting_that_opens_the_graph_to_the_network_is_noted() -> None:
    done = doctor(ROS_AUTOMATIC_DISCOVERY_RANGE="SUBNET")
    assert done.returncode == 0
    assert line_about("ROS graph", done.stdout).startswith("note")
