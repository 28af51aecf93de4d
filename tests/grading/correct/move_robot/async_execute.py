"""One thread for everything: execute is a coroutine, a timer makes the steps and the coroutine awaits each."""

import math

import rclpy
from course_interfaces.action import MoveRobot
from geometry_msgs.msg import Point
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future

from course_kit.robot import SimulatedRobot


class MoveRobotServer(Node):
    def __init__(self):
        super().__init__("move_robot_server")
        self.robot = SimulatedRobot()
        self.goal = None
        self.step_done = None
        self.create_timer(0.002, self.step)
        ActionServer(
            self,
            MoveRobot,
            "move_robot",
            self.execute,
            goal_callback=self.decide,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def decide(self, goal):
        if self.goal is not None or not all(0 <= value <= 10 for value in (goal.target.x, goal.target.y)):
            return GoalResponse.REJECT
        self.goal = (goal.target.x, goal.target.y)
        return GoalResponse.ACCEPT

    def step(self):
        if self.step_done is not None:
            self.robot.step_towards(*self.goal)
            done, self.step_done = self.step_done, None
            done.set_result(None)

    async def execute(self, goal_handle):
        start = self.robot.position
        total = math.dist(start, self.goal)
        result = MoveRobot.Result()
        while self.robot.position != self.goal and not goal_handle.is_cancel_requested:
            done = self.step_done = Future(executor=self.executor)
            await done
            left = math.dist(self.robot.position, self.goal)
            here = Point(x=self.robot.position.x, y=self.robot.position.y, z=0.0)
            goal_handle.publish_feedback(
                MoveRobot.Feedback(position=here, distance_remaining=left, progress=(total - left) / total)
            )
        if self.robot.position == self.goal:
            goal_handle.succeed()
        else:
            goal_handle.canceled()
        self.goal = None
        result.final_position = Point(x=self.robot.position.x, y=self.robot.position.y, z=0.0)
        result.distance_travelled = math.dist(start, self.robot.position)
        return result


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(MoveRobotServer())
