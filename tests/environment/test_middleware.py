"""An RMW_IMPLEMENTATION that is not installed: the course says so and goes on, where rclpy would end the process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit.environment import middleware
from tests.course_copy import TEMPERATURE, Course, starter

if TYPE_CHECKING:
    from pathlib import Path

MISSING = "rmw_cyclonedds_cpp"
SENTENCE = f"RMW_IMPLEMENTATION is set to '{MISSING}', but no such middleware is installed here"
PROGRAM = "import rclpy; rclpy.init(); print(rclpy.get_rmw_implementation_identifier())"


def run(program: str, **variables: str) -> subprocess.CompletedProcess[str]:
    environ = {name: value for name, value in os.environ.items() if name not in middleware.VARIABLES}
    return subprocess.run(
        [sys.executable, "-c", program], env={**environ, **variables}, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip


@pytest.mark.parametrize("name", middleware.VARIABLES)
def test_a_program_goes_on_with_fast_dds_and_says_so_in_one_line(name: str) -> None:
    done = run(PROGRAM, **{name: MISSING})
    assert (done.returncode, done.stdout) == (0, f"{middleware.SUPPORTED}\n"), done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert f"{name} is set to '{MISSING}'" in done.stderr
    assert f"Unset {name}" in done.stderr


def test_the_commands_answer_and_keep_their_output_clean(tmp_path: Path, domain: int) -> None:
    course = Course(tmp_path)
    variables = {"RMW_IMPLEMENTATION": MISSING, "ROS_DOMAIN_ID": str(domain)}
    graded = course.run("grade", TEMPERATURE, str(starter(tmp_path)), "--format", "json", **variables)
    assert json.loads(graded.stdout)["score"] == 1.0
    assert graded.stderr.count(SENTENCE) == 1
    listed = subprocess.run(
        [sys.executable, "-m", "course_kit.ros2cli", "service", "list", "--no-daemon"], env=course.environ(**variables),
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert (listed.returncode, listed.stdout) == (0, "")
    assert listed.stderr.count(SENTENCE) == 1


def test_a_middleware_that_works_and_does_not_suit_the_courses_types_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RMW_IMPLEMENTATION", middleware.SUPPORTED)
    assert middleware.explain_middleware() == ""
    monkeypatch.setenv("RMW_IMPLEMENTATION", MISSING)  # as of a sourced ROS that has it
    assert "work with rmw_fastrtps_cpp only" in middleware.explain_middleware()


def test_a_grade_does_not_depend_on_the_users_middleware(monkeypatch: pytest.MonkeyPatch) -> None:
    from course_kit.grading.workers.worker import variables_of

    monkeypatch.setattr(middleware, "choose_middleware", lambda: "")  # as in a sourced ROS that has it
    monkeypatch.setenv("RMW_IMPLEMENTATION", MISSING)
    assert variables_of(whole=False, own_graph=True)["RMW_IMPLEMENTATION"] == middleware.SUPPORTED
    assert variables_of(whole=False, own_graph=False)["RMW_IMPLEMENTATION"] == MISSING
