"""The picture of the robot in its corridor, moved by what nodes publish."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from action_msgs.msg import GoalStatus, GoalStatusArray
from course_interfaces.action import Deliver
from rclpy.node import Node
from std_msgs.msg import Bool
from unique_identifier_msgs.msg import UUID

from course_kit import lab, panels
from tests.waiting import wait_until

if TYPE_CHECKING:
    from course_kit.panels.corridor import CorridorPicture

pytestmark = pytest.mark.usefixtures("own_lab")


class Carrier(Node):
    def __init__(self) -> None:
        super().__init__("carrier")
        self.declare_parameter("room_distances_m", [2.0, 4.0])
        self.declare_parameter("room_names", ["kitchen", "office"])


def expect(panel: CorridorPicture, words: str) -> str:
    wait_until(lambda: words in panel.widget.line, lambda: panel.widget.line)
    return str(panel.widget.picture)


def feedback(phase: str, left: float, goal: int = 0) -> None:
    told = Deliver.Feedback(phase=phase, distance_remaining=left)
    number = UUID(uuid=[goal] * 16)
    lab.publish("/deliver/_action/feedback", Deliver.Impl.FeedbackMessage, goal_id=number, feedback=told)


def end_all(status: int) -> None:
    lab.publish("/deliver/_action/status", GoalStatusArray, status_list=[GoalStatus(status=status)])


def test_the_robot_moves_by_what_is_published() -> None:
    panel = panels.arena()
    assert "has not been at the dock yet" in panel.widget.line
    lab.start(Carrier)  # tells its parameters
    wait_until(lambda: "office" in panel.widget.picture)
    lab.publish("/docked", Bool, data=True)
    assert "translate(1.2px" in expect(panel, "The robot stands at dock. The door is shut.")
    feedback("door", 2.0)
    assert 'class="ck-door ck-asked"' in expect(panel, "The door is asked to open.")
    feedback("driving", 1.0)
    assert "translate(3.6px" in expect(panel, "is 1.0 m from the dock, on its way to kitchen. The door is open")
    feedback("driving", 0.0)
    end_all(GoalStatus.STATUS_SUCCEEDED)
    assert "translate(6.0px" in expect(panel, "The robot stands at kitchen.")
    feedback("driving", 2.0, goal=1)
    feedback("driving", 0.5, goal=1)
    expect(panel, "is 3.5 m from the dock, on its way to office.")  # the dock is as far from the kitchen
    still = panel.still()
    assert re.search(r"kitchen</text>.*>2 m</text>.*office</text>", still, re.DOTALL)
    assert "on its way to office. The door is open." in still
    assert not re.findall(r"https?:|<script|url\(|@import|<button", still)
    panels.arena()
    assert panel.widget.line == "This panel has ended. Run its cell again to use it."


def test_a_door_that_does_not_open_is_shut_and_other_rooms_are_drawn() -> None:
    carrier = lab.start(Carrier)
    panel = panels.arena()
    feedback("door", 4.0)
    expect(panel, "The door is asked to open.")
    end_all(GoalStatus.STATUS_ABORTED)
    expect(panel, "The door is shut.")
    lab.set_parameters_blocking(carrier, room_names=["attic", "cellar"])
    wait_until(lambda: "cellar" in panel.widget.picture)
