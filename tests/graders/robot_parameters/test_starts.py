"""Programs that somebody else starts, or that are no Python source: what can be graded of them is."""

from __future__ import annotations

import shlex
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment, grading
from tests.graders.robot_parameters.conftest import EXERCISE, SOLUTION, not_passed
from tests.grading.conftest import wait_for_node

if TYPE_CHECKING:
    from collections.abc import Iterator

STARTS = {"start_arguments", "start_file", "start_invalid"}


@pytest.fixture
def node_running(domain: int) -> Iterator[int]:
    program = subprocess.Popen(
        [sys.executable, str(SOLUTION)], env=environment.child_environment(ROS_DOMAIN_ID=str(domain))
    )
    wait_for_node("velocity_limiter", domain)
    yield domain
    program.send_signal(signal.SIGINT)
    program.wait(200)


def test_a_command_is_given_arguments_and_files() -> None:
    report = grading.grade(EXERCISE, exec_command=shlex.join([sys.executable, str(SOLUTION)]))
    assert not_passed(report) == []


@pytest.mark.usefixtures("node_running")
def test_attached_to_a_node_it_grades_all_but_the_starts_and_leaves_the_node_as_it_was() -> None:
    for _ in range(2):
        report = grading.grade(EXERCISE, attach=True)
        assert {check for check, status, _, _ in not_passed(report) if status == "skipped"} == STARTS
        assert len(not_passed(report)) == len(STARTS)
        assert report.passed
    told = {check.id: check.message for check in report.checks}
    assert "with --attach your program is already running" in told["start_arguments"]


def test_what_a_provoked_error_prints_is_marked_as_such(worker: grading.Worker) -> None:
    report = grading.grade(EXERCISE, SOLUTION, worker=worker)
    lines = report.stderr.splitlines()
    assert "velocity_limiter cannot start" in lines[-2]
    assert lines[-1].startswith(
        "[Your program printed the lines above when it was started with: --ros-args -p wheel_diameter:="
    )
