"""Drill 5: everybody waits in one queue.

One client waits half a second for its weight. Eight clients that ask together: the last one waits four
seconds.

The program runs. Repair what is wrong with it:

- Names. The program, which its own `main` starts, offers the service `/weigh` (`example_interfaces/srv/AddTwoInts`).
- The weight. It answers with `a + b`.
- Half a second. The scale needs half a second: an answer comes 0.4 s after its request at the earliest, and 1.2 s at
  the latest.
- Together. Eight clients that ask together all have their answers within 3 s.
"""

import time

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Scale(Node):
    def __init__(self):
        super().__init__("scale")
        self.create_service(AddTwoInts, "weigh", self.weigh)

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
