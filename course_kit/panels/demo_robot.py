"""The robot of the lessons, to be sent about on a map: how an action is used comes before how one is written.

It is no answer to exercise 2, and not meant to become one: it drives along x first and then along y, and cannot climb.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node

from course_kit.panels.arena_map import Place
from course_kit.robot import SimulatedRobot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rclpy.action.server import ServerGoalHandle

    from course_kit.ros.messages import Message

_TELLS_S = 0.2  # seconds from one position to the next
_STEPS = 4  # from one feedback message to the next: five a metre, as exercise 2 asks for


class DemoRobot(Node):
    """Offers `course_interfaces/action/MoveRobot` as /move_robot, publishes /position, drives at `max_velocity`."""

    def __init__(self) -> None:
        super().__init__("demo_robot")
        from course_interfaces.action import MoveRobot
        from geometry_msgs.msg import Point

        self._type = MoveRobot
        self._place = self.create_publisher(Point, "position", 10)
        self.create_timer(_TELLS_S, self._tell)
        self._robot = SimulatedRobot()
        limits = FloatingPointRange(from_value=0.2, to_value=2.0)
        about = ParameterDescriptor(description="how fast it drives, in m/s", floating_point_range=[limits])
        self.declare_parameter("max_velocity", self._robot.SPEED, about)
        self._free = threading.Semaphore()
        self._server = ActionServer(
            self,
            MoveRobot,
            "move_robot",
            self._execute,
            goal_callback=self._decide,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def _tell(self) -> None:
        """Say where it is, to whom it may concern: a recording of something else stays free of it."""
        if self._place.get_subscription_count():
            self._place.publish(self._point())

    def _decide(self, goal: Message) -> GoalResponse:
        size = SimulatedRobot.ARENA_SIZE
        reachable = 0.0 <= goal.target.x <= size and 0.0 <= goal.target.y <= size and goal.target.z == 0.0
        return GoalResponse.ACCEPT if reachable and self._free.acquire(blocking=False) else GoalResponse.REJECT

    def _execute(self, goal_handle: ServerGoalHandle) -> Message:
        target = Place(goal_handle.request.target.x, goal_handle.request.target.y)
        way = self._way_to(target)
        try:
            for number, _ in enumerate(self._drive_in_steps(target)):
                if goal_handle.is_cancel_requested:
                    goal_handle.canceled()
                    return self._result(target, way, "stopped on the way")
                if number % _STEPS == 0:
                    goal_handle.publish_feedback(self._feedback(target, way))
            goal_handle.publish_feedback(self._feedback(target, way))  # it is there
            goal_handle.succeed()
            return self._result(target, way, "arrived")
        finally:
            self._free.release()

    def _drive_in_steps(self, target: Place) -> Iterator[None]:
        """Drive, and yield before each step."""
        for corner in (Place(target.x, self._robot.position.y), target):
            while tuple(self._robot.position) != corner:
                yield
                self._robot.SPEED = self.get_parameter("max_velocity").value
                self._robot.step_towards(*corner)

    def _way_to(self, target: Place) -> float:
        here = self._robot.position
        return abs(target.x - here.x) + abs(target.y - here.y)

    def _feedback(self, target: Place, way: float) -> Message:
        left = self._way_to(target)
        done = 1.0 - left / way if way else 1.0
        return self._type.Feedback(position=self._point(), distance_remaining=left, progress=done)

    def _result(self, target: Place, way: float, message: str) -> Message:
        driven = way - self._way_to(target)
        return self._type.Result(final_position=self._point(), distance_travelled=driven, message=message)

    def _point(self) -> Message:
        from geometry_msgs.msg import Point

        return Point(x=self._robot.position.x, y=self._robot.position.y)
