"""Drill 5, repaired."""

import time

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Scale(Node):
    def __init__(self):
        super().__init__("scale")
        self.create_service(AddTwoInts, "weigh", self.weigh, callback_group=ReentrantCallbackGroup())

    def weigh(self, request, response):
        time.sleep(0.5)  # until the scale is steady
        response.sum = request.a + request.b
        return response


def main():
    rclpy.init()
    try:
        rclpy.spin(Scale(), MultiThreadedExecutor(num_threads=8))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
