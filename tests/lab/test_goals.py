from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest
from example_interfaces.action import Fibonacci
from std_srvs.srv import SetBool

from course_kit import lab
from tests.lab.action_nodes import Fibonaccis
from tests.lab.nodes import Switch

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab

pytestmark = pytest.mark.usefixtures("own_lab")


def test_a_goal_from_its_acceptance_to_its_result() -> None:
    lab.start(Fibonaccis)
    heard: list[Any] = []
    ended: list[str] = []

    async def follow() -> tuple[Any, list[Any], Any]:
        goal = await lab.send_goal(
            "/fibonacci", Fibonacci, order=5, on_feedback=heard.append, on_result=lambda goal: ended.append(goal.status)
        )
        assert goal.accepted
        return goal, [list(feedback.sequence) async for feedback in goal], await goal.result(timeout=10)

    goal, feedback, result = asyncio.run(follow())
    assert feedback == [[0, 1, 1], [0, 1, 1, 2], [0, 1, 1, 2, 3], [0, 1, 1, 2, 3, 5]]
    assert list(result.sequence) == [0, 1, 1, 2, 3, 5]
    assert goal.status == "SUCCEEDED"
    assert [list(one.sequence) for one in goal.feedback] == feedback
    assert heard == goal.feedback
    assert ended == ["SUCCEEDED"]
    assert repr(goal) == "Goal(order=5) for /fibonacci: SUCCEEDED"


def test_the_same_from_a_program() -> None:
    lab.start(Fibonaccis)
    goal = lab.send_goal_blocking("fibonacci", Fibonacci, Fibonacci.Goal(order=3))
    assert list(goal.result_blocking().sequence) == [0, 1, 1, 2]
    assert goal.done
    assert goal.cancel_blocking() is False  # it has ended


def test_a_rejected_goal_is_no_error_but_has_no_result() -> None:
    lab.start(Fibonaccis)
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=-1)
    assert (goal.accepted, goal.status) == (False, "REJECTED")
    assert goal.cancel_blocking() is False
    assert repr(goal) == "Goal(order=-1) for /fibonacci: REJECTED"
    with pytest.raises(lab.LabError, match="/fibonacci has rejected this goal, so there will be no result"):
        goal.result_blocking()


def test_a_misspelt_action_gets_the_nearest_one() -> None:
    lab.start(Fibonaccis)
    expected = r"No node runs the action /fibonaci \(waited 0.2 s\).*/fibonacci \[example_interfaces/action/Fibonacci\]"
    with pytest.raises(lab.ActionNotFoundError, match=expected):
        lab.send_goal_blocking("/fibonaci", Fibonacci, order=1, timeout=0.2)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"oder": 1}, "no field 'oder' in a goal of example_interfaces/action/Fibonacci; it has order. Did you mean"),
        ({"order": 1.5}, "'order' in .* has the type int32 and takes a whole number in its range"),
    ],
)
def test_wrong_fields(fields: dict[str, Any], message: str) -> None:
    lab.start(Fibonaccis)
    with pytest.raises(lab.FieldError, match=message):
        lab.send_goal_blocking("/fibonacci", Fibonacci, **fields)


def test_the_client_is_used_again_until_its_server_goes(own_lab: Lab) -> None:
    lab.start(Fibonaccis)
    for _ in range(2):
        lab.send_goal_blocking("/fibonacci", Fibonacci, order=1).result_blocking()
    waitables = [type(one).__name__ for one in own_lab.engine.node.waitables]
    assert waitables.count("GoalClient") == 1
    lab.stop()
    assert "GoalClient" not in [type(one).__name__ for one in own_lab.engine.node.waitables]


def test_a_goal_inside_a_callback_is_refused() -> None:
    class Asking(Switch):
        def answer(self, request: Any, response: Any) -> Any:
            del request
            try:
                lab.send_goal_blocking("/fibonacci", Fibonacci, order=1)
            except lab.DeadlockError as error:
                response.message = str(error)
            return response

    lab.start(Fibonaccis)
    lab.start(Asking)
    assert "send_goal_async() there" in lab.call_blocking("/switch", SetBool, data=True).message


def test_feedback_that_comes_at_once_and_with_the_result_is_not_lost() -> None:
    class Hurried(Fibonaccis):
        def execute(self, goal: Any) -> Any:
            for number in range(goal.request.order):
                goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))
            goal.succeed()
            return Fibonacci.Result()

    lab.start(Hurried)
    for _ in range(5):
        goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=40)
        goal.result_blocking()
        assert [one.sequence[0] for one in goal.feedback] == list(range(40))


def test_what_a_feedback_function_raises_is_told_and_harms_nobody(capsys: pytest.CaptureFixture[str]) -> None:
    def fail(_: Any) -> None:
        message = "no such bar"
        raise ValueError(message)

    lab.start(Fibonaccis)
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=2, on_feedback=fail, on_result=fail)
    assert list(goal.result_blocking().sequence) == [0, 1, 1]
    shown = capsys.readouterr().err
    assert shown.count("fail raised ValueError: no such bar") == 2
    assert "Traceback" not in shown


SERVER = """
import os, rclpy
from tests.lab.action_nodes import Waiting
rclpy.init()
rclpy.spin(Waiting(), executor=rclpy.executors.MultiThreadedExecutor(2))
"""


def test_a_server_that_dies_or_is_started_again_has_lost_its_goals() -> None:
    told: list[Any] = []
    server = lab.script("server", SERVER, mode="background")
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=9, timeout=20, on_result=told.append)
    server.process.kill()
    with pytest.raises(lab.NoAnswerError, match="The server of /fibonacci went away: its program ended"):
        goal.result_blocking()
    assert (goal.status, told) == ("UNKNOWN", [goal])
    lab.script("server", SERVER, mode="background")
    lost = lab.send_goal_blocking("/fibonacci", Fibonacci, order=9, timeout=20)
    lab.script("server", SERVER, mode="background")
    with pytest.raises(lab.NoAnswerError, match="The server of /fibonacci went away: its program ended"):
        lost.result_blocking()
    assert lost.done
