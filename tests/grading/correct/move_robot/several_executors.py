"""Two nodes with an executor each: one drives, the other only watches the clock. Goals wait for nobody."""

import math
import threading

import rclpy
from course_interfaces.action import MoveRobot
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node

from course_kit.robot import SimulatedRobot


class Heartbeat(Node):
    def __init__(self):
        super().__init__("heartbeat")
        self.create_timer(0.05, lambda: None)


class MoveRobotServer(Node):
    def __init__(self):
        super().__init__("move_robot_server")
        self.robot = SimulatedRobot()
        self.taken = threading.Semaphore()
        ActionServer(
            self,
            MoveRobot,
            "/move_robot",
            self.drive,
            goal_callback=self.decide,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def decide(self, goal):
        inside = all(0.0 <= value <= 10.0 for value in (goal.target.x, goal.target.y))
        return GoalResponse.ACCEPT if inside and self.taken.acquire(blocking=False) else GoalResponse.REJECT

    def drive(self, handle):
        begin, goal = self.robot.position, handle.request.target
        way = math.dist(begin, (goal.x, goal.y))
        left, stopped = way, False
        while left > 0.0 and not stopped:
            self.robot.step_towards(goal.x, goal.y)
            here = self.robot.position
            left = math.dist(here, (goal.x, goal.y))
            feedback = MoveRobot.Feedback(distance_remaining=left, progress=1.0 - left / way)
            feedback.position.x, feedback.position.y = here
            handle.publish_feedback(feedback)
            stopped = handle.is_cancel_requested and left > 0.0
        result = MoveRobot.Result(distance_travelled=way - left, message="stopped" if stopped else "there")
        result.final_position.x, result.final_position.y = self.robot.position
        handle.canceled() if stopped else handle.succeed()
        self.taken.release()
        return result


def main():
    rclpy.init()
    executors = [MultiThreadedExecutor(num_threads=4), SingleThreadedExecutor()]
    threads = []
    for executor, node in zip(executors, (MoveRobotServer(), Heartbeat()), strict=True):
        executor.add_node(node)
        threads.append(threading.Thread(target=executor.spin))
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


if __name__ == "__main__":
    main()
