"""Feedback first and every 0.2 m, no more; goal callbacks as coroutines; two nodes, several Node classes."""

import math

from course_interfaces.action import MoveRobot
from geometry_msgs.msg import Point
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node

from course_kit.robot import SimulatedRobot


class RobotNode(Node):
    def __init__(self, name="robot"):
        super().__init__(name)
        self.robot = SimulatedRobot()
        self.owner = None


class MoveRobotServer(RobotNode):
    def __init__(self):
        super().__init__("move_robot_server")
        self.server = ActionServer(
            self,
            MoveRobot,
            "move_robot",
            self.execute,
            callback_group=MutuallyExclusiveCallbackGroup(),
            goal_callback=self.accept_goal,
            cancel_callback=self.accept_cancel,
            result_timeout=30,
        )

    async def accept_goal(self, goal):
        if self.owner is None and 0 <= goal.target.x <= 10 and 0 <= goal.target.y <= 10:
            self.owner = goal
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT

    async def accept_cancel(self, _):
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        goal = (goal_handle.request.target.x, goal_handle.request.target.y)
        first = last = told = self.robot.position
        travelled = 0.0
        self.tell(goal_handle, last, math.dist(last, goal), 0.0)
        while last != goal and not goal_handle.is_cancel_requested:
            self.robot.step_towards(*goal)
            travelled += math.dist(last, self.robot.position)
            last = self.robot.position
            if math.dist(told, last) >= 0.199 or last == goal:
                told = last
                left = math.dist(last, goal)
                self.tell(goal_handle, last, left, travelled / (travelled + left))
        if last == goal:
            goal_handle.succeed()
        else:
            goal_handle.canceled()
        self.owner = None
        self.get_logger().info(f"from {first} to {last}")
        return MoveRobot.Result(final_position=Point(x=last.x, y=last.y), distance_travelled=travelled)

    def tell(self, goal_handle, here, left, progress):
        position = Point(x=here.x, y=here.y)
        goal_handle.publish_feedback(MoveRobot.Feedback(position=position, distance_remaining=left, progress=progress))
