"""Drill 3: the call that never returns.

`/add` answers at once. `/add_doubled` asks `/add`, and nobody ever gets an answer from it.

The program runs. Repair what is wrong with it:

- Names. The program, which its own `main` starts, offers the services `/add` and `/add_doubled`, both of the type
  `example_interfaces/srv/AddTwoInts`.
- The sum. `/add` answers with `a + b`.
- Twice the sum. `/add_doubled` answers with twice that, each time, within 1 s.
"""

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Calculator(Node):
    def __init__(self):
        super().__init__("calculator")
        self.create_service(AddTwoInts, "add", self.add)
        self.create_service(AddTwoInts, "add_doubled", self.add_doubled)
        self.adder = self.create_client(AddTwoInts, "add")

    def add(self, request, response):
        response.sum = request.a + request.b
        return response

    def add_doubled(self, request, response):
        answer = self.adder.call(request)
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
