"""Drill 3, repaired."""

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Calculator(Node):
    def __init__(self):
        super().__init__("calculator")
        self.create_service(AddTwoInts, "add", self.add)
        own = MutuallyExclusiveCallbackGroup()
        self.create_service(AddTwoInts, "add_doubled", self.add_doubled, callback_group=own)
        self.adder = self.create_client(AddTwoInts, "add")

    def add(self, request, response):
        response.sum = request.a + request.b
        return response

    async def add_doubled(self, request, response):
        answer = await self.adder.call_async(request)
        response.sum = 2 * answer.sum
        return response


def main():
    rclpy.init()
    try:
        rclpy.spin(Calculator())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
