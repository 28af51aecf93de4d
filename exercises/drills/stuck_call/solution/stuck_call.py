"""Drill 3, repaired."""

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Adder(Node):
    def __init__(self):
        super().__init__("adder")
        self.create_service(AddTwoInts, "add", self.add)

    def add(self, request, response):
        response.sum = request.a + request.b
        return response


class Doubler(Node):
    def __init__(self):
        super().__init__("doubler")
        self.adder = self.create_client(AddTwoInts, "add", callback_group=MutuallyExclusiveCallbackGroup())
        self.create_service(AddTwoInts, "add_doubled", self.add_doubled)

    async def add_doubled(self, request, response):
        answer = await self.adder.call_async(request)
        response.sum = 2 * answer.sum
        return response


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    for node in (Adder(), Doubler()):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
