"""A node for tests of what happens on other versions of rclpy."""

from __future__ import annotations

import threading
from typing import Any

from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import String


class Everything(Node):
    """Serves /add_two_ints, runs /fibonacci, and keeps what comes on /words."""

    def __init__(self) -> None:
        super().__init__("everything")
        self.words: list[str] = []
        self.heard = threading.Event()
        self.create_service(AddTwoInts, "add_two_ints", self.add)
        self.create_subscription(String, "words", self.hear, 10)
        ActionServer(self, Fibonacci, "fibonacci", self.execute)

    def add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response

    def hear(self, message: Any) -> None:
        self.words.append(message.data)
        self.heard.set()

    def execute(self, goal: Any) -> Any:
        sequence = [0, 1]
        for _ in range(1, goal.request.order):
            sequence.append(sequence[-1] + sequence[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)
