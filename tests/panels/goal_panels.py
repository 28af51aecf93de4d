"""The action server of the tests of panels."""

from __future__ import annotations

import threading
from typing import Any

from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node


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
