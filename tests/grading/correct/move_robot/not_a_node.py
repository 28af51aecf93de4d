"""The named class is no Node: it has one. Goals go through a queue to a thread that owns the robot."""

import math
import queue
import threading

import rclpy
from course_interfaces.action import MoveRobot
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.task import Future

from course_kit.robot import SimulatedRobot


class MoveRobotServer:
    def __init__(self):
        self.node = rclpy.create_node("move_robot_server")
        self.robot = SimulatedRobot()
        self.idle = True
        self.moves = queue.Queue()
        self.server = ActionServer(
            self.node,
            MoveRobot,
            "move_robot",
            self.execute,
            goal_callback=self.goal,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        threading.Thread(target=self.drive_all, daemon=True).start()

    def goal(self, goal):
        inside = not (math.isnan(goal.target.x) or math.isnan(goal.target.y))
        inside = inside and 0 <= goal.target.x <= 10 and 0 <= goal.target.y <= 10
        if inside and self.idle:
            self.idle = False
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT

    async def execute(self, goal_handle):
        arrived = Future(executor=self.node.executor)
        self.moves.put((goal_handle, arrived))
        return await arrived

    def drive_all(self):
        while True:
            goal_handle, arrived = self.moves.get()
            arrived.set_result(self.drive(goal_handle))

    def drive(self, goal_handle):
        target = goal_handle.request.target
        begin = self.robot.position
        way = math.hypot(target.x - begin.x, target.y - begin.y)
        result = MoveRobot.Result(message="the robot stands")
        while True:
            here = self.robot.position
            left = math.hypot(target.x - here.x, target.y - here.y)
            feedback = MoveRobot.Feedback(distance_remaining=left, progress=1.0 - left / way if way else 1.0)
            feedback.position.x, feedback.position.y = here
            goal_handle.publish_feedback(feedback)
            if left < 0.02 or goal_handle.is_cancel_requested:
                break
            self.robot.step_towards(target.x, target.y)
        self.idle = True
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.succeed()
        result.final_position = feedback.position
        result.distance_travelled = way - left
        return result


def main():
    rclpy.init()
    server = MoveRobotServer()
    while rclpy.ok():
        rclpy.spin_once(server.node, timeout_sec=0.1)


if __name__ == "__main__":
    main()
