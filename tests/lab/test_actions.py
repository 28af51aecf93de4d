from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, get_action_names_and_types
from rclpy.node import Node

from course_kit import lab

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab


class Counter(Node):
    """Runs /count: fails for a negative order."""

    def __init__(self) -> None:
        super().__init__("counter")
        self.server = ActionServer(self, Fibonacci, "count", self.execute)

    def execute(self, goal: Any) -> Any:
        if goal.request.order < 0:
            message = "cannot count down"
            raise ValueError(message)
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1])


class Asker(Node):
    """Sends goals to /count."""

    def __init__(self) -> None:
        super().__init__("asker")
        self.client = ActionClient(self, Fibonacci, "count")

    def ask(self, order: int) -> Any:
        sent = self.client.send_goal_async(Fibonacci.Goal(order=order))
        rclpy.spin_until_future_complete(self, sent, timeout_sec=10)
        answered = sent.result().get_result_async()
        rclpy.spin_until_future_complete(self, answered, timeout_sec=10)
        return answered.result()


@pytest.mark.usefixtures("own_lab")
def test_an_action_server_outlives_its_crash(capsys: pytest.CaptureFixture[str]) -> None:
    lab.start(Counter)
    asker = lab.start(Asker)
    assert repr(lab.nodes()) == (
        "asker (Asker)\n    sends goals to /count [example_interfaces/action/Fibonacci]\n"
        "counter (Counter)\n    runs the action /count [example_interfaces/action/Fibonacci]"
    )
    assert asker.client.wait_for_server(timeout_sec=10)
    assert asker.ask(3).status == GoalStatus.STATUS_SUCCEEDED
    capsys.readouterr()
    assert asker.ask(-1).status == GoalStatus.STATUS_ABORTED
    shown = capsys.readouterr().err
    assert shown.startswith("counter: execute raised ValueError: cannot count down\n  test_actions.py, line ")
    assert "Traceback" not in shown


class Undecided(Node):
    """Raises when it is asked whether it takes a goal."""

    def __init__(self) -> None:
        super().__init__("undecided")
        ActionServer(self, Fibonacci, "asks", lambda _: Fibonacci.Result(), goal_callback=self.doubt)

    def doubt(self, _: Any) -> None:
        message = "no idea"
        raise ValueError(message)


@pytest.mark.usefixtures("own_lab")
def test_a_goal_callback_that_raises_is_told_with_its_line(capsys: pytest.CaptureFixture[str]) -> None:
    lab.start(Undecided)
    with pytest.raises(lab.NoAnswerError, match="/asks neither accepted nor rejected the goal"):
        lab.send_goal_blocking("/asks", Fibonacci, timeout=0.5)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "undecided: doubt raised ValueError: no idea"
    assert lines[1].startswith("  test_actions.py, line ")
    assert lines[2].startswith("  The caller gets no answer.")


def test_stopping_takes_actions_off_the_graph(own_lab: Lab) -> None:
    counter, asker = lab.start(Counter), lab.start(Asker)
    eye = own_lab.engine.node
    assert [name for name, _ in get_action_names_and_types(eye)] == ["/count"]
    lab.stop()
    assert get_action_names_and_types(eye) == []
    assert counter is not asker  # both are still held, as they are in a notebook


@pytest.mark.usefixtures("own_lab")
def test_a_reply_that_comes_before_the_sender_is_ready_is_not_lost() -> None:
    lab.start(Counter)
    asker = lab.start(Asker)
    assert asker.client.wait_for_server(timeout_sec=10)
    asker.client._client_handle = SlowToReturn(asker.client._client_handle)
    assert list(asker.ask(1).result.sequence) == [0, 1]


class SlowToReturn:
    """The handle of an action client, whose `send_goal_request` returns when the server has long answered."""

    def __init__(self, handle: Any) -> None:
        self.handle = handle

    def __getattr__(self, name: str) -> Any:
        return getattr(self.handle, name)

    def __enter__(self) -> Any:
        return self.handle.__enter__()

    def __exit__(self, *error: object) -> None:
        self.handle.__exit__(*error)

    def send_goal_request(self, request: Any) -> int:
        sequence = self.handle.send_goal_request(request)
        time.sleep(0.3)  # what the operating system may do to a thread at any moment
        return int(sequence)
