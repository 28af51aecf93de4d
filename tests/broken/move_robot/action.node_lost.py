# action.node_lost: execute spins the node, which a MultiThreadedExecutor runs
"""Exercise 2, solved: an action server that drives a robot to a point, with feedback, one goal at a time."""

import math
import threading

import rclpy
from course_interfaces.action import MoveRobot
from geometry_msgs.msg import Point
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node

from course_kit.robot import Position, SimulatedRobot

TOLERANCE = 0.01  # metres


class MoveRobotServer(Node):
    """Offers /move_robot."""

    def __init__(self) -> None:
        super().__init__("move_robot_server")
        self.robot = SimulatedRobot()
        self.busy = threading.Lock()  # held while a goal has the robot; two threads cannot both get it
        self.server = ActionServer(
            self,
            MoveRobot,
            "move_robot",
            execute_callback=self.execute,
            goal_callback=self.decide_on_goal,
            cancel_callback=self.decide_on_cancel,
        )

    def decide_on_goal(self, goal: MoveRobot.Goal) -> GoalResponse:
        """Accept what can be reached, one goal at a time."""
        inside = all(0.0 <= value <= SimulatedRobot.ARENA_SIZE for value in (goal.target.x, goal.target.y))
        if not inside:  # NaN, too, is not inside: it compares false
            self.get_logger().info("Rejected: the target lies outside the arena")
            return GoalResponse.REJECT
        if not self.busy.acquire(blocking=False):
            self.get_logger().info("Rejected: another goal is running")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def decide_on_cancel(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        """The robot can stop at any time."""
        del goal_handle
        return CancelResponse.ACCEPT

    def execute(self, goal_handle: ServerGoalHandle) -> MoveRobot.Result:
        """Drive to the target, step by step."""
        try:
            return self.drive(goal_handle)
        finally:
            self.busy.release()  # whatever has happened, the next goal may have the robot

    def drive(self, goal_handle: ServerGoalHandle) -> MoveRobot.Result:
        """Drive until the target is reached or the goal is cancelled."""
        begin = self.robot.position
        target = Position(goal_handle.request.target.x, goal_handle.request.target.y)
        whole_way = math.dist(begin, target)
        while (remaining := math.dist(self.robot.position, target)) > TOLERANCE:
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return self.result(begin, "cancelled on the way")
            self.tell(goal_handle, remaining, whole_way)
            self.robot.step_towards(*target)
            rclpy.spin_once(self, timeout_sec=0.0)
        self.tell(goal_handle, remaining, whole_way)  # the last one says that the robot is there
        goal_handle.succeed()
        return self.result(begin, "arrived")

    def tell(self, goal_handle: ServerGoalHandle, remaining: float, whole_way: float) -> None:
        """Send feedback with so many metres left of the whole way."""
        progress = 1.0 - remaining / whole_way if whole_way else 1.0
        goal_handle.publish_feedback(
            MoveRobot.Feedback(position=self.point(), distance_remaining=remaining, progress=progress)
        )

    def result(self, begin: Position, message: str) -> MoveRobot.Result:
        """What has become of a goal that began at `begin`; the way was straight."""
        travelled = math.dist(begin, self.robot.position)
        return MoveRobot.Result(final_position=self.point(), distance_travelled=travelled, message=message)

    def point(self) -> Point:
        """Where the robot is, as a message."""
        return Point(x=self.robot.position.x, y=self.robot.position.y)


def main() -> None:
    """Run the node until Ctrl-C: one thread drives, another answers whoever wants to cancel."""
    rclpy.init()
    node = MoveRobotServer()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
