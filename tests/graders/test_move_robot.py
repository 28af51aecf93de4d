"""Exercise 2 graded without being started by us; styles, mistakes and checks: tests/proof."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from importlib import metadata
from typing import TYPE_CHECKING

from course_kit import environment, grading
from tests.grading.conftest import ROOT, wait_for_node

if TYPE_CHECKING:
    from pathlib import Path

EXERCISE = "move_robot"
SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"


def failures(report: grading.Report) -> list[tuple[str, str, str]]:
    return [(check.id, check.status, check.message) for check in report.checks if check.status != "passed"]


def test_attach_grades_a_robot_that_has_driven_before(domain: int) -> None:
    """At a quarter of its speed: what is attached to keeps its own time scale."""
    with subprocess.Popen(
        [sys.executable, str(SOLUTION)],
        env=environment.child_environment(ROS_DOMAIN_ID=str(domain), COURSE_KIT_TIME_SCALE="0.25"),
        stderr=subprocess.DEVNULL,
    ) as program:
        try:
            wait_for_node("move_robot_server", domain)
            for _ in range(2):  # the second time the robot stands where the first has left it
                report = grading.grade(EXERCISE, attach=True)
                assert failures(report) == []
        finally:
            program.send_signal(signal.SIGINT)
            program.wait(200)


WAKES_THE_EXECUTOR = (7, 1, 9)  # from this rclpy on a future that is awaited belongs to the executor of who awaits it
WAITING = {  # in the solution: execute waits for a thread before it drives, and one thread spins
    "import threading": "import threading\nfrom rclpy.task import Future",
    "    def execute(self": "    async def execute(self",
    "        try:\n            return self.drive": """        motors = Future()
        threading.Timer(0.3, lambda: motors.set_result("on")).start()
        await motors
        try:
            return self.drive""",
    "MultiThreadedExecutor(num_threads=4)": "rclpy.executors.SingleThreadedExecutor()",
}


def test_future_without_an_executor_that_wakes_nobody_is_named(worker: grading.Worker, tmp_path: Path) -> None:
    program = SOLUTION.read_text()
    for old, new in WAITING.items():
        assert program.count(old) == 1, old
        program = program.replace(old, new)
    (tmp_path / "waiting.py").write_text(program)
    # By this seed a goal is cancelled on its way to an edge, too: that costs no second check.
    report = grading.grade(EXERCISE, tmp_path / "waiting.py", worker=worker, seed=3)
    failed = [check for check in report.checks if check.status == "failed"]
    version = tuple(map(int, re.findall(r"\d+", metadata.version("rclpy"))[:3]))
    if version >= WAKES_THE_EXECUTOR:
        assert [check.id for check in failed] == ["cancel"]  # one thread cannot hear it
        return
    assert [(check.id, check.diagnosis) for check in failed] == [("succeeds", "service.future")]
    assert "the one made in line" in failed[0].message
    assert "motors = Future()" in failed[0].message


def test_what_is_wrong_with_some_goals_costs_one_check(worker: grading.Worker, tmp_path: Path) -> None:
    """The others are judged by goals that go right."""
    place = "goal.target.x, goal.target.y)"
    for lost, old, new in (
        ({"accepted"}, f"in ({place})", f"in ({place[:-1]}, math.hypot({place}))"),  # a quarter of a circle
        ({"arrives"}, "TOLERANCE = 0.01", "TOLERANCE = 0.08"),
    ):
        path = tmp_path / f"{min(lost)}.py"
        path.write_text(SOLUTION.read_text().replace(old, new))
        report = grading.grade(EXERCISE, path, worker=worker, seed=3)
        assert {check_id for check_id, _, _ in failures(report)} == lost
