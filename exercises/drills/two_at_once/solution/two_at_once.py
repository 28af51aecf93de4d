"""Drill 7, repaired."""

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
        if self.busy:
            return GoalResponse.REJECT
        self.busy = True
        return GoalResponse.ACCEPT

    def execute(self, goal_handle):
        time.sleep(1.0)  # plans the way of the brush
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
