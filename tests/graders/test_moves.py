"""The geometry of exercise 2's grader, and what it makes of feedback and of a program's last words."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest
from course_interfaces.action import MoveRobot
from geometry_msgs.msg import Point

from course_kit.graders._moves import (
    ArenaPoint,
    HastyError,
    Move,
    distance_beside,
    explain_refusal,
    find_jump,
    place_inside,
    require_distance,
    send_goal,
)
from course_kit.grading.checks.evidence import Evidence, Failed, UnseenError
from course_kit.grading.checks.graded_goal import CANCELED, SUCCEEDED, is_spread
from course_kit.grading.checks.grader_node import ReceivedFeedback
from course_kit.grading.diagnosis import causes
from course_kit.grading.model.job import Job, ProcessStatus
from course_kit.grading.model.submission import Submission

ORIGIN = ArenaPoint(0.0, 0.0)


@pytest.mark.parametrize(
    ("place", "distance"),
    [((1.0, 0.5), 0.5), ((-1.0, 0.0), 1.0), ((3.0, 0.0), 1.0), ((0.0, 0.0), 0.0), ((1.5, -0.2), 0.2)],
)
def test_distance_from_the_way(place: tuple[float, float], distance: float) -> None:
    assert distance_beside(ORIGIN, ArenaPoint(2.0, 0.0), ArenaPoint(*place)) == pytest.approx(distance)


@pytest.mark.parametrize("at", [5.0, 4.8])
def test_a_far_place_in_the_arena_is_found_at_each_angle(at: float) -> None:
    here = ArenaPoint(at, at)
    for number in range(400):
        length = 6.0 + number % 6 / 10
        assert math.dist(here, place_inside(here, length, number * math.tau / 400)) == pytest.approx(length)


@pytest.mark.parametrize(
    ("times", "spread"),
    [
        ([0.2, 0.4, 0.6, 0.8, 1.0], True),
        ([0.0, 0.25, 0.5, 0.75, 1.0], True),
        ([0.6, 0.7, 0.8, 0.9, 1.0], True),
        ([0.96, 0.97, 0.98, 0.99, 1.0], False),
        ([0.0, 0.01, 0.02, 0.03, 0.04], False),
        ([0.0, 0.97, 0.98, 0.99, 1.0], False),
        ([0.5, 0.5, 0.5, 0.5, 0.5], False),
        ([], False),
    ],
)
def test_feedback_is_spread_or_in_a_bunch(times: list[float], spread: bool) -> None:
    assert is_spread([(time, 0.0) for time in times], 0.0, 1.0) == spread


@pytest.mark.parametrize(("middle_s", "spread"), [(0.5, True), (0.75, True), (0.95, False)])
def test_a_message_from_the_middle_of_the_way_may_come_late_but_not_at_the_end(middle_s: float, spread: bool) -> None:
    assert is_spread([(0.0, 1.0), (0.2, 0.8), (middle_s, 0.5), (0.98, 0.1), (1.0, 0.0)], 0.0, 1.0) == spread


def heard(*values: tuple[float, float]) -> list[Any]:
    return [
        ReceivedFeedback(SimpleNamespace(progress=progress, distance_remaining=left), 0.0) for progress, left in values
    ]


@pytest.mark.parametrize(
    ("values", "fact"),
    [
        ([(0.0, 2.0), (0.5, 1.0), (0.5, 1.0), (1.0, 0.0)], ""),
        ([(0.0, 2.0), (0.5, 1.0), (0.42345678901, 0.9)], "progress=0.5, then 0.4234568"),
        ([(0.0, 2.0), (0.5, 1.0), (0.6, 1.2)], "distance_remaining=1, then 1.2"),
        ([(0.0, 2.0), (1.2, 0.0)], "progress=1.2, which"),
        ([(-0.1, 2.0)], "progress=-0.1, which"),
        ([(math.nan, 2.0)], "progress=nan, which"),
        ([(0.1, math.nan), (0.2, 1.0)], "distance_remaining=nan, then 1"),
        ([(0.1, 1.0), (0.2, 1.0 + 1e-9)], ""),
    ],
)
def test_jumps_in_feedback_are_found(values: list[tuple[float, float]], fact: str) -> None:
    assert find_jump(heard(*values)).startswith(fact)
    assert bool(find_jump(heard(*values))) == bool(fact)


def goal(*left: float, over_at: float | None = None, began_at: float = 0.0) -> Any:
    """A goal to (2, 0) with feedback from where so much of the way was left."""
    told = [
        SimpleNamespace(came_s=0.0, feedback=SimpleNamespace(position=SimpleNamespace(x=2.0 - one, y=0.0)))
        for one in left
    ]
    return SimpleNamespace(shown="a goal", feedback=told, over_at=over_at, began_at=began_at)


@pytest.mark.parametrize(
    ("code", "left", "waited_s", "slow", "kind"),
    [
        ("action.cancel_refused", [1.0, 0.4], 0.1, False, Failed),
        ("action.cancel_refused", [1.0, 0.2], 0.1, False, HastyError),
        ("action.cancel_refused", [1.0, 0.2], 0.1, True, UnseenError),  # so near it may be refused
        ("action.cancel_refused", [], 0.1, False, HastyError),
        ("action.cancel_refused", [], 0.1, True, Failed),
        ("action.cancel_blocked", [0.1], 0.9, True, UnseenError),  # a second is allowed
        ("action.cancel_blocked", [0.1], 1.1, True, HastyError),
        ("service.blocks", [1.0], 5.0, False, Failed),
        (None, [0.1], 0.1, False, HastyError),
        (None, [0.1], 0.1, True, UnseenError),
    ],
)
def test_a_refusal_counts_where_cancelling_has_to_work(
    code: str | None, left: list[float], waited_s: float, slow: bool, kind: type
) -> None:
    failed = Failed(Evidence(), "", code, breaks="cancel")
    found = explain_refusal(failed, goal(*left), ArenaPoint(2.0, 0.0), waited_s, slow=slow)
    assert type(found) is kind
    assert found.diagnosis != "service.blocks"
    assert found.breaks == "cancel"


@pytest.mark.parametrize(
    ("status", "final", "travelled", "right"),
    [
        (SUCCEEDED, 2.0, 1.04, True),
        (SUCCEEDED, 2.0, 1.06, False),
        (SUCCEEDED, 2.0, 2.0, False),  # all that was driven since the start
        (CANCELED, 1.5, 0.5, True),
        (CANCELED, 1.5, 1.0, False),  # the whole way of a goal that was cancelled
    ],
)
def test_the_distance_is_that_of_this_goal_as_far_as_it_went(
    status: int, final: float, travelled: float, right: bool
) -> None:
    result = MoveRobot.Result(final_position=Point(x=final), distance_travelled=travelled)
    ended = MoveRobot.Impl.GetResultService.Response(status=status, result=result)
    move = Move(ArenaPoint(1.0, 0.0), ArenaPoint(2.0, 0.0), goal(), ended)
    if right:
        require_distance(move)
        return
    with pytest.raises(Failed):
        require_distance(move)


SOURCE = "\n".join(f"line_{number}()" for number in range(1, 20))
TRACE = """[ERROR] [1.0] [move_robot_server.action_server]: Error raised in execute callback: x
Traceback (most recent call last):
  File "/site-packages/rclpy/action/server.py", line 336, in {function}
    execute_result = await await_or_execute(execute_callback, goal_handle)
  File "answer.py", line 7, in execute
    line_7()
{error}
"""


def cause_of(
    status: str, error: str = "", *, mode: str = "run", stderr: str = "", function: str = "_execute_goal"
) -> Any:
    text = TRACE.format(error=error, function=function) if error else stderr
    job = Job("course_kit.graders.move_robot", mode, 1, Submission("answer.py", "answer.py", SOURCE))
    return causes.explain_status(status, ProcessStatus(running=True, stderr=text), job)


@pytest.mark.parametrize(
    ("error", "code", "fact"),
    [
        (
            (
                "rclpy._rclpy_pybind11.RCLError: Failed to update goal state: goal_handle attempted invalid "
                "transition from state SUCCEEDED with event SUCCEED, at goal_handle.c:100"
            ),
            "action.wrong_terminal",
            "called succeed() in line 7",
        ),
        ("AssertionError: The 'progress' field must be of type 'float'", "field.type", "'progress' must be a float"),
        (
            "ZeroDivisionError: float division by zero",
            None,
            "ZeroDivisionError: float division by zero in line 7: line_7()",
        ),
        ("MemoryError", "limit.memory", "256 MB"),
    ],
)
def test_exceptions_in_execute_are_told_apart(error: str, code: str | None, fact: str) -> None:
    found, message = cause_of("ABORTED", error)
    assert found == code
    assert fact in message


def test_a_target_a_millimetre_outside_is_not_shown_as_one_on_the_edge() -> None:
    node: Any = SimpleNamespace(goal=lambda _name, target: SimpleNamespace(target=target))
    assert send_goal(node, ArenaPoint(10.001, 5.0)).shown == "a goal with target=(10.001, 5, 0)"
