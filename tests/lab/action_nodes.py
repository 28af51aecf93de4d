"""Action servers a learner might write, for the tests of goals."""

from __future__ import annotations

import threading
import time
from typing import Any

from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from std_srvs.srv import Trigger


class Fibonaccis(Node):
    """Runs /fibonacci: rejects negative orders, agrees to cancel, and steps when it is allowed to."""

    def __init__(self, name: str = "fibonaccis") -> None:
        super().__init__(name)
        self.go_on = threading.Event()
        self.go_on.set()
        self.first = threading.Event()
        self.create_service(Trigger, "ping", lambda _, response: response)
        self.server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            self.execute,
            goal_callback=self.decide,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def decide(self, goal: Any) -> GoalResponse:
        return GoalResponse.REJECT if goal.order < 0 else GoalResponse.ACCEPT

    def execute(self, goal: Any) -> Any:
        sequence = [0, 1]
        for _ in range(1, goal.request.order):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sequence[-1] + sequence[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
            self.first.set()
            while not self.go_on.wait(0.01) and not goal.is_cancel_requested:
                pass
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)


class Waiting(Fibonaccis):
    """Waits after its first feedback until it is allowed to go on or is cancelled."""

    def __init__(self) -> None:
        super().__init__("waiting")
        self.go_on.clear()


class Stubborn(Node):
    """Runs /stubborn: never agrees to cancel, and takes until `release`."""

    def __init__(self) -> None:
        super().__init__("stubborn")
        self.release = threading.Event()
        self.busy = threading.Event()
        self.server = ActionServer(self, Fibonacci, "stubborn", self.execute)

    def execute(self, goal: Any) -> Any:
        self.busy.set()
        while not self.release.is_set():
            time.sleep(0.01)
        goal.succeed()
        return Fibonacci.Result(sequence=[7])
