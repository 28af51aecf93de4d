"""Drill 8: everything is done, and it says ABORTED.

All loaves are baked and the result is right. Yet for every client the goal ends as ABORTED.

The program runs. Repair what is wrong with it:

- Names. The program, which its own `main` starts, offers the action `/bake` (`example_interfaces/action/Fibonacci`).
- Baking. A goal bakes `order` loaves, each in a tenth of a second, and ends SUCCEEDED, with their numbers in
  `sequence` of the result: 0, 1, 2, ...
- Feedback. After each loaf the feedback holds the numbers so far.
"""

import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Baker(Node):
    def __init__(self):
        super().__init__("baker")
        self.server = ActionServer(self, Fibonacci, "bake", self.execute)

    def execute(self, goal_handle):
        loaves = []
        for loaf in range(goal_handle.request.order):
            time.sleep(0.1)
            loaves.append(loaf)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=loaves))
        return Fibonacci.Result(sequence=loaves)


def main():
    rclpy.init()
    try:
        rclpy.spin(Baker())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
