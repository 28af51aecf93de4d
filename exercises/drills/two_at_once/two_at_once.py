"""Drill 7: two goals, one arm.

The arm rejects a goal while it paints. Send two goals quickly, one after the other, and it accepts both.

The program runs. Repair what is wrong with it:

- Names. The program, which its own `main` starts, offers the action `/paint` (`example_interfaces/action/Fibonacci`).
- Painting. A goal plans for a second, makes `order` strokes, and succeeds with their numbers in `sequence`: 0, 1, 2,
  ...
- One arm. From the moment one goal is accepted until it has ended, every other goal is rejected.
- And then. After that the next one is accepted.
"""

import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, GoalResponse
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Painter(Node):
    def __init__(self):
        super().__init__("painter")
        self.busy = False
        self.server = ActionServer(self, Fibonacci, "paint", self.execute, goal_callback=self.decide)

    def decide(self, goal):
        return GoalResponse.REJECT if self.busy else GoalResponse.ACCEPT

    def execute(self, goal_handle):
        time.sleep(1.0)  # plans the way of the brush
        self.busy = True
        strokes = []
        for stroke in range(goal_handle.request.order):
            time.sleep(0.1)
            strokes.append(stroke)
        self.busy = False
        goal_handle.succeed()
        return Fibonacci.Result(sequence=strokes)


def main():
    rclpy.init()
    try:
        rclpy.spin(Painter(), MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
