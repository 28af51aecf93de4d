"""Exercise 2: an action server that drives a robot to a point.

The node's name, the action's name and its type are right already; keep them. All the rest is yours: how to drive, what
to tell on the way, which goals to accept, and how to stop when a client wants that.
"""

import rclpy
from course_interfaces.action import MoveRobot
from rclpy.action import ActionServer
from rclpy.node import Node

from course_kit.robot import SimulatedRobot


class MoveRobotServer(Node):
    """Offers /move_robot."""

    def __init__(self):
        super().__init__("move_robot_server")
        self.robot = SimulatedRobot()
        self.server = ActionServer(self, MoveRobot, "move_robot", execute_callback=self.execute)

    def execute(self, goal_handle):
        """Drive to the target of one goal.

        goal_handle.request.target        where to; x and y in metres
        self.robot.position               where the robot is: (x, y) in metres
        self.robot.step_towards(x, y)     drives 5 cm and takes 0.05 s

        goal_handle.publish_feedback(...) tells the client, with a MoveRobot.Feedback: position, the straight way
                                          left (x and y), progress from 0 to 1
        goal_handle.is_cancel_requested   True when the client wants it to stop
        goal_handle.succeed(), .abort() or .canceled() say how the goal ended

        Returns a MoveRobot.Result, filled in.
        """
        # Your code goes here.
        return MoveRobot.Result()


def main():
    rclpy.init()
    node = MoveRobotServer()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
