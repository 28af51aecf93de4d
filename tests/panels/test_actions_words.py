"""What a panel says of goals and draws of ways, without a graph."""

from __future__ import annotations

import math

import pytest
from course_interfaces.action import MoveRobot
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import Point
from std_srvs.srv import Trigger

from course_kit.panels import goal_panel


@pytest.mark.parametrize(
    ("goal", "feedback", "expected"),
    [
        (Fibonacci.Goal(order=10), None, (0.0, "no feedback yet")),
        (Fibonacci.Goal(order=10), Fibonacci.Feedback(sequence=[0, 1, 1]), (0.2, "term 2 of 10")),
        (Fibonacci.Goal(order=2), Fibonacci.Feedback(sequence=[0, 1, 1, 2, 3]), (1.0, "term 4 of 2")),
        (Fibonacci.Goal(order=0), Fibonacci.Feedback(sequence=[0, 1]), (None, "7 feedback messages")),
        (MoveRobot.Goal(), MoveRobot.Feedback(progress=0.25), (0.25, "25%")),
        (MoveRobot.Goal(), MoveRobot.Feedback(progress=1.5), (1.0, "150%")),
        (MoveRobot.Goal(), MoveRobot.Feedback(progress=math.nan), (None, "the feedback's progress is nan")),
    ],
)
def test_progress_is_what_the_feedback_says(goal: object, feedback: object, expected: object) -> None:
    assert goal_panel.progress(goal, feedback, 7) == expected


def test_one_feedback_message_is_not_many() -> None:
    assert goal_panel.progress(Trigger.Request(), Trigger.Request(), 1).text == "1 feedback message"


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (Fibonacci.Result(sequence=[0, 1, 1]), "sequence=[0, 1, 1]"),
        (Fibonacci.Result(), "sequence=[]"),
        (Fibonacci.Result(sequence=range(40)), "sequence=[..., 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39]"),
        (
            MoveRobot.Result(final_position=Point(x=1.0, y=2.346), message="<b>arrived</b>"),
            "final_position={x=1.00, y=2.35, z=0.00}, distance_travelled=0.00, message='<b>arrived</b>'",
        ),
        (Trigger.Response(success=True, message="long " * 100), "success=True, message='long long"),
    ],
)
def test_a_message_is_one_short_line(message: object, expected: str) -> None:
    shown = goal_panel.message(message)
    assert shown.startswith(expected)
    assert len(shown) <= 160


def test_a_status_is_a_sentence_with_the_name_ros_has_for_it() -> None:
    assert goal_panel.status("CANCELED") == "The goal was cancelled (CANCELED)."
    assert goal_panel.status("REJECTED", "Another goal") == "Another goal was rejected by the server (REJECTED)."
