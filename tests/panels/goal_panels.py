"""What the tests of panels for actions share: a server, and a wait for what a panel shows."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any

from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node

if TYPE_CHECKING:
    from collections.abc import Callable

PATIENCE_S = 30.0  # against hanging only


class Gate(Node):
    """Runs /gate: one goal at a time, of order 1 to 20; each step after the first waits for `open` or a cancel."""

    def __init__(self) -> None:
        super().__init__("gate")
        self.open = threading.Event()
        self.agrees = True
        self.free = threading.Semaphore()
        self.server = ActionServer(
            self, Fibonacci, "gate", self.execute, goal_callback=self.decide, cancel_callback=self.cancel
        )

    def decide(self, goal: Any) -> GoalResponse:
        fits = 1 <= goal.order <= 20 and self.free.acquire(blocking=False)
        return GoalResponse.ACCEPT if fits else GoalResponse.REJECT

    def cancel(self, goal: Any) -> CancelResponse:
        del goal
        return CancelResponse.ACCEPT if self.agrees else CancelResponse.REJECT

    def execute(self, goal: Any) -> Any:
        feedback = Fibonacci.Feedback(sequence=[0, 1])
        try:
            for _ in range(1, goal.request.order):
                feedback.sequence.append(sum(feedback.sequence[-2:]))
                goal.publish_feedback(feedback)
                while not self.open.wait(0.01) and not goal.is_cancel_requested:
                    pass
                if goal.is_cancel_requested:
                    goal.canceled()
                    return Fibonacci.Result(sequence=feedback.sequence)
            goal.succeed()
            return Fibonacci.Result(sequence=feedback.sequence)
        finally:
            self.free.release()


def until(condition: Callable[[], object], what: Callable[[], object] = lambda: "nothing") -> None:
    """Wait until it is so."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"It did not come to that. There is: {what()}"
        time.sleep(0.005)
