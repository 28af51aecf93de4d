"""No SimulatedRobot: a motion loop of its own, in real time, at half the speed, telling every fourth step."""

import math
import time

import rclpy
from course_interfaces.action import MoveRobot
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

SPEED = 0.5
PERIOD = 0.05


class MoveRobotServer(Node):
    def __init__(self):
        super().__init__("move_robot_server")
        self.x = self.y = 0.0
        self.running = None
        self.server = ActionServer(
            self,
            MoveRobot,
            "/move_robot",
            execute_callback=self.execute,
            goal_callback=self.check_goal,
            handle_accepted_callback=self.begin,
            cancel_callback=self.check_cancel,
        )

    def check_goal(self, goal):
        in_arena = 0.0 <= goal.target.x <= 10.0 and 0.0 <= goal.target.y <= 10.0
        idle = self.running is None or not self.running.is_active
        return GoalResponse.ACCEPT if in_arena and idle else GoalResponse.REJECT

    def check_cancel(self, goal_handle):
        self.get_logger().info(f"asked to cancel {goal_handle.goal_id.uuid[0]}")
        return CancelResponse.ACCEPT

    def begin(self, goal_handle):
        self.running = goal_handle
        goal_handle.execute()

    def execute(self, goal_handle):
        goal = goal_handle.request.target
        length = math.hypot(goal.x - self.x, goal.y - self.y)
        steps = math.ceil(length / (SPEED * PERIOD))
        travelled = 0.0
        for step in range(steps):
            if goal_handle.is_cancel_requested:
                break
            part = 1.0 / (steps - step)
            dx, dy = (goal.x - self.x) * part, (goal.y - self.y) * part
            self.x += dx
            self.y += dy
            travelled += math.hypot(dx, dy)
            time.sleep(PERIOD)
            if step % 4 == 0 or step == steps - 1:
                self.publish(goal_handle, goal, travelled / length)
        result = MoveRobot.Result(distance_travelled=travelled)
        result.final_position.x = self.x
        result.final_position.y = self.y
        if goal_handle.is_cancel_requested:
            result.message = "cancelled"
            goal_handle.canceled()
        else:
            result.message = "done"
            goal_handle.succeed()
        return result

    def publish(self, goal_handle, goal, progress):
        feedback = MoveRobot.Feedback()
        feedback.position.x = self.x
        feedback.position.y = self.y
        feedback.distance_remaining = math.hypot(goal.x - self.x, goal.y - self.y)
        feedback.progress = min(progress, 1.0)
        goal_handle.publish_feedback(feedback)


def main(args=None):
    rclpy.init(args=args)
    node = MoveRobotServer()
    executor = MultiThreadedExecutor(num_threads=4)
    try:
        rclpy.spin(node, executor=executor)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
