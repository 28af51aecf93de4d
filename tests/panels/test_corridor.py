"""The picture of the robot in its corridor, moved by what nodes publish."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest
from action_msgs.msg import GoalStatus, GoalStatusArray
from course_interfaces.action import Deliver
from rclpy.action import ActionServer
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, Float64

from course_kit import lab, panels
from tests.waiting import wait_until

if TYPE_CHECKING:
    from course_kit.panels.corridor import CorridorPicture

pytestmark = pytest.mark.usefixtures("own_lab")


class Carrier(Node):
    """Has rooms, and delivers at once."""

    def __init__(self) -> None:
        super().__init__("carrier")
        self.declare_parameter("room_distances_m", [2.0, 4.0])
        self.declare_parameter("room_names", ["kitchen", "office"])
        self.server = ActionServer(self, Deliver, "deliver", self.execute)

    def execute(self, goal: Any) -> Any:
        goal.succeed()
        return Deliver.Result(message="here it is")


class Door(Node):
    def __init__(self) -> None:
        super().__init__("door")
        self.declare_parameter("locked", True)


def expect(panel: CorridorPicture, words: str) -> str:
    wait_until(lambda: words in panel.widget.view["line"], lambda: panel.widget.view["line"])
    return str(panel.widget.view["picture"])


def feedback(phase: str, left: float) -> None:
    told = Deliver.Feedback(phase=phase, distance_remaining=left)
    lab.publish("/deliver/_action/feedback", Deliver.Impl.FeedbackMessage, feedback=told)


def test_the_robot_moves_by_what_is_published() -> None:
    panel = panels.arena()
    assert "has not been at the dock yet" in panel.widget.view["line"]
    lab.start(Carrier)  # tells its parameters
    wait_until(lambda: panel.widget.rooms == ["dock", "kitchen", "office"])
    lab.publish("/docked", Bool, data=True)
    assert "translate(1.2px" in expect(panel, "The robot stands at dock. The door is shut.")
    lab.publish("/odometry_distance", Float64, data=7.0)
    feedback("door", 2.0)
    assert 'class="ck-door ck-asked"' in expect(panel, "The door is asked to open.")
    feedback("driving", 2.0)
    lab.publish("/odometry_distance", Float64, data=8.0)
    assert "translate(3.6px" in expect(panel, "is 1.0 m from the dock, on its way to kitchen. The door is open")
    lab.publish("/odometry_distance", Float64, data=9.5)
    expect(panel, "The robot stands at kitchen.")
    lab.publish("/battery", BatteryState, percentage=0.25, power_supply_health=BatteryState.POWER_SUPPLY_HEALTH_DEAD)
    expect(panel, "The battery has 25%, low.")
    still = panel.still()
    assert re.search(r"kitchen</text>.*>2 m</text>.*office</text>.*>25 %, low</text>", still, re.DOTALL)
    assert "The robot stands at kitchen. The door is open." in still
    assert not re.findall(r"https?:|<script|url\(|@import|<button", still)


def test_a_door_that_does_not_open_is_shut_and_one_that_is_locked_shows_so() -> None:
    lab.start(Carrier)
    panel = panels.arena()
    feedback("door", 4.0)
    expect(panel, "The door is asked to open.")
    aborted = GoalStatus(status=GoalStatus.STATUS_ABORTED)
    lab.publish("/deliver/_action/status", GoalStatusArray, status_list=[aborted])
    expect(panel, "The door is shut.")
    lab.start(Door)
    expect(panel, "The door is locked.")


def test_a_button_sends_the_robot_off() -> None:
    lab.start(Carrier)
    panel = panels.arena()
    assert panel.widget.rooms == ["dock", "kitchen", "office"]
    panel.widget._handle_custom_msg({"do": "go", "room": "office"}, [])
    expect(panel, 'The delivery to "office" has succeeded (SUCCEEDED). Its message: here it is.')
    panels.arena()
    assert panel.widget.view["line"] == "This panel has ended. Run its cell again to use it."
