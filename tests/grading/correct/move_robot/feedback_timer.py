"""A timer tells the clients ten times a second of real time; it is told, too, where a move begins and ends."""

import math
import threading

import rclpy
from course_interfaces.action import MoveRobot
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from course_kit.robot import SimulatedRobot


class MoveRobotServer(Node):
    def __init__(self):
        super().__init__("move_robot_server")
        group = ReentrantCallbackGroup()
        self.robot = SimulatedRobot()
        self.lock = threading.Lock()
        self.reserved = False
        self.move = None
        self.create_timer(0.1, self.tell, callback_group=group)
        self.server = ActionServer(
            self,
            MoveRobot,
            "move_robot",
            execute_callback=self.execute,
            goal_callback=self.goal_callback,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=group,
        )

    def goal_callback(self, goal):
        point = (goal.target.x, goal.target.y)
        if not all(map(math.isfinite, point)) or min(point) < 0.0 or max(point) > 10.0:
            return GoalResponse.REJECT
        with self.lock:
            if self.reserved:
                return GoalResponse.REJECT
            self.reserved = True
        return GoalResponse.ACCEPT

    def tell(self):
        with self.lock:
            if self.move is None:
                return
            goal_handle, target, length = self.move
            feedback = MoveRobot.Feedback()
            feedback.position.x, feedback.position.y = self.robot.position
            feedback.distance_remaining = math.dist(self.robot.position, target)
            feedback.progress = 1.0 - feedback.distance_remaining / length if length else 1.0
            goal_handle.publish_feedback(feedback)

    def execute(self, goal_handle):
        begin = self.robot.position
        target = (goal_handle.request.target.x, goal_handle.request.target.y)
        with self.lock:
            self.move = (goal_handle, target, math.dist(begin, target))
        self.tell()
        while self.robot.position != target and not goal_handle.is_cancel_requested:
            self.robot.step_towards(*target)
        self.tell()
        with self.lock:
            self.move = None
            self.reserved = False
        goal_handle.canceled() if goal_handle.is_cancel_requested else goal_handle.succeed()
        result = MoveRobot.Result(distance_travelled=math.dist(begin, self.robot.position))
        result.final_position.x, result.final_position.y = self.robot.position
        return result


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=6)
    executor.add_node(MoveRobotServer())
    executor.spin()


if __name__ == "__main__":
    main()
