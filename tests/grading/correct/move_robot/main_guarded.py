"""A guarded main(), and a flag for the one goal at a time."""

import math

import rclpy
from course_interfaces.action import MoveRobot
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from course_kit.robot import SimulatedRobot


class MoveRobotServer(Node):
    def __init__(self):
        super().__init__("move_robot_server")
        self.robot = SimulatedRobot()
        self.busy = False
        self.server = ActionServer(
            self, MoveRobot, "move_robot", self.execute, goal_callback=self.on_goal, cancel_callback=self.on_cancel
        )

    def on_goal(self, goal):
        x, y = goal.target.x, goal.target.y
        if self.busy or not (0.0 <= x <= 10.0 and 0.0 <= y <= 10.0):
            return GoalResponse.REJECT
        self.busy = True
        return GoalResponse.ACCEPT

    def on_cancel(self, _):
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        try:
            return self.drive(goal_handle)
        finally:
            self.busy = False

    def drive(self, goal_handle):
        target = goal_handle.request.target.x, goal_handle.request.target.y
        begin = self.robot.position
        way = math.dist(begin, target)
        while math.dist(self.robot.position, target) > 0.001:
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return self.result(begin)
            self.robot.step_towards(*target)
            self.tell(goal_handle, target, way)
        goal_handle.succeed()
        return self.result(begin)

    def tell(self, goal_handle, target, way):
        feedback = MoveRobot.Feedback()
        feedback.position.x, feedback.position.y = self.robot.position
        feedback.distance_remaining = math.dist(self.robot.position, target)
        feedback.progress = 1.0 - feedback.distance_remaining / way
        goal_handle.publish_feedback(feedback)

    def result(self, begin):
        result = MoveRobot.Result()
        result.final_position.x, result.final_position.y = self.robot.position
        result.distance_travelled = math.dist(begin, self.robot.position)
        return result


def main():
    rclpy.init()
    node = MoveRobotServer()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()
