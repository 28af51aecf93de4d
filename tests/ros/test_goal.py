"""A goal on its way, whoever spins the node."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_action_status_default

from course_kit.ros.goal import GoalClient, GoalTracker

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

PATIENCE = 60.0
PARTS = Fibonacci.Impl


class LateServer:
    """An action server of plain services, that publishes its feedback when told to, after the result if need be."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.goal_id: Any = None
        names = {part: f"/late/_action/{part}" for part in ("send_goal", "cancel_goal", "get_result")}
        self.parts: list[Any] = [
            node.create_service(PARTS.SendGoalService, names["send_goal"], self.accept),
            node.create_service(PARTS.CancelGoalService, names["cancel_goal"], self.refuse_to_cancel),
            node.create_service(PARTS.GetResultService, names["get_result"], self.end),
        ]
        self.feedback = node.create_publisher(PARTS.FeedbackMessage, "/late/_action/feedback", 10)
        self.status = node.create_publisher(
            PARTS.GoalStatusMessage, "/late/_action/status", qos_profile_action_status_default
        )

    def accept(self, request: Any, response: Any) -> Any:
        self.goal_id, response.accepted = request.goal_id, request.goal.order > 0
        return response

    def refuse_to_cancel(self, _: Any, response: Any) -> Any:
        return response

    def end(self, _: Any, response: Any) -> Any:
        response.status, response.result.sequence = 4, [0, 1]
        return response

    def tell(self, *sequence: int) -> None:
        self.feedback.publish(
            PARTS.FeedbackMessage(goal_id=self.goal_id, feedback=Fibonacci.Feedback(sequence=sequence))
        )


class Pair:
    """A client and its server in one process, and one executor for both."""

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain_id)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.server, asking = (LateServer(Node("server", context=self.context)), Node("asking", context=self.context))
        for node in (self.server.node, asking):
            self.executor.add_node(node)
        self.client = GoalClient(asking, Fibonacci, "late")
        self.spin_until(self.client.server_is_ready)

    def spin_until(self, is_true: Callable[[], bool]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not is_true():
            assert time.monotonic() < deadline
            self.executor.spin_once(timeout_sec=0.1)

    def send(self, order: int) -> GoalTracker:
        tracker = GoalTracker(self.client, Fibonacci.Goal(order=order))
        tracker.begin()
        self.spin_until(lambda: tracker.accepted is not None)
        return tracker


@pytest.fixture
def pair(domain: int) -> Iterator[Pair]:
    made = Pair(domain)
    yield made
    made.client.destroy()
    made.executor.shutdown()
    made.context.try_shutdown()


def test_feedback_that_comes_after_the_result_is_not_lost(pair: Pair) -> None:
    tracker = pair.send(order=1)
    pair.spin_until(lambda: tracker.ended)
    assert (tracker.status, list(tracker.result.sequence)) == ("SUCCEEDED", [0, 1])
    pair.server.tell(0, 1, 1)
    pair.spin_until(lambda: bool(tracker.feedback))
    assert list(tracker.feedback[0].sequence) == [0, 1, 1]
    assert tracker.identifier == bytes(pair.server.goal_id.uuid)


def test_a_goal_whose_server_has_gone_is_lost(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(GoalTracker, "_take_result", lambda *_: None)  # as if the result had not come
    tracker = pair.send(order=1)
    pair.server.node.destroy_publisher(pair.server.feedback)
    pair.spin_until(lambda: tracker.ended)
    assert (tracker.status, tracker.result) == ("UNKNOWN", None)
