"""Drill 8, repaired."""

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
        goal_handle.succeed()
        return Fibonacci.Result(sequence=loaves)


def main():
    rclpy.init()
    try:
        rclpy.spin(Baker())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
