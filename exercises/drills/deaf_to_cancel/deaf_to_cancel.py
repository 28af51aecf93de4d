"""Drill 2: nobody hears the cancel.

You cancel a countdown, and it counts on. The answer to your request comes when the goal is over.

The program runs. Repair what is wrong with it:

- Names. The program, which its own `main` starts, offers the action `/count_down`
  (`example_interfaces/action/Fibonacci`).
- Counting. A goal counts from `order` down to 1, one number every 0.2 s, and succeeds; `sequence` of its result holds
  the numbers.
- Step by step. After each number the feedback holds the numbers so far.
- Cancelling. A running goal can be cancelled: the request is accepted within 1 s, the goal ends CANCELED, and the
  next goal works.
"""

import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Countdown(Node):
    def __init__(self):
        super().__init__("countdown")
        self.server = ActionServer(self, Fibonacci, "count_down", self.execute, cancel_callback=self.cancel)

    def cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        counted = []
        for number in range(goal_handle.request.order, 0, -1):
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result(sequence=counted)
            counted.append(number)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=counted))
            time.sleep(0.2)
        goal_handle.succeed()
        return Fibonacci.Result(sequence=counted)


def main():
    rclpy.init()
    try:
        rclpy.spin(Countdown())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
