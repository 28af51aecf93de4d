"""The robot of lesson 2 can be looked at and copied by every learner: it must not pass as exercise 2."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit import grading

if TYPE_CHECKING:
    from pathlib import Path

SUBMISSION = """
from course_kit.panels.demo_robot import DemoRobot


class MoveRobotServer(DemoRobot):
    pass
"""


def test_the_demo_robot_is_no_answer_to_exercise_2(tmp_path: Path) -> None:
    (tmp_path / "move_robot.py").write_text(SUBMISSION)
    report = grading.grade("move_robot", tmp_path / "move_robot.py", seed=3)
    assert report.score == 0
    assert report.checks[0].diagnosis == "start.import"  # it does not exist for a submission
