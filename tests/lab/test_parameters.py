"""Parameters and subscriptions of the lab, against real nodes."""

from __future__ import annotations

import asyncio
import threading
from typing import TYPE_CHECKING, Any

import pytest
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterEvent,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64

from course_kit import lab
from course_kit.lab.parameters import Descriptor, Range

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab

pytestmark = pytest.mark.usefixtures("own_lab")
NAMES = ["name", "speed", "gears", "frame", "tags", "late"]


class Robot(Node):
    """Has a parameter of each interesting sort, and does not go backwards."""

    def __init__(self) -> None:
        super().__init__("robot")
        self.declare_parameter("name", "r2d2")
        limits = FloatingPointRange(from_value=-1.0, to_value=5.0)
        self.declare_parameter("speed", 1.0, ParameterDescriptor(description="m/s", floating_point_range=[limits]))
        steps = IntegerRange(from_value=1, to_value=9, step=2)
        self.declare_parameter("gears", 5, ParameterDescriptor(additional_constraints="odd", integer_range=[steps]))
        self.declare_parameter("frame", "base", ParameterDescriptor(read_only=True))
        self.declare_parameter("tags", ["a", "b"])
        self.declare_parameter("late", Parameter.Type.DOUBLE)
        self.add_on_set_parameters_callback(self.judge)

    def judge(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == "speed" and parameter.value < 0.0:
                return SetParametersResult(successful=False, reason="speed must not be negative")
            if parameter.name == "name" and parameter.value == "bug":
                raise RuntimeError("a bug")
        return SetParametersResult(successful=True)


class Bare(Node):
    """Offers no parameter services."""

    def __init__(self) -> None:
        super().__init__("bare", start_parameter_services=False)


def names(event: ParameterEvent) -> list[str]:
    return [parameter.name for parameter in event.changed_parameters]


def get(*names: str) -> Any:
    return lab.get_parameters_blocking("/robot", *names)


def test_all_parameters_are_read_in_the_nodes_order_and_those_of_ros_come_last() -> None:
    lab.start(Robot)
    values = asyncio.run(lab.get_parameters("/robot"))
    assert list(values)[:6] == NAMES
    assert "use_sim_time" in list(values)[6:]
    assert values["speed"] == 1.0
    assert values["tags"] == ["a", "b"]
    assert values["late"] is None
    assert repr(values).splitlines()[:2] == ["name: 'r2d2'", "speed: 1.0"]


def test_some_parameters_are_read_by_name_and_the_node_may_stand_for_its_name() -> None:
    node = lab.start(Robot)
    assert lab.get_parameters_blocking(node, "gears", "name") == {"gears": 5, "name": "r2d2"}
    assert asyncio.run(lab.get_parameters("robot", "frame")) == {"frame": "base"}


def test_set_says_what_was_set_and_what_was_refused_and_why() -> None:
    lab.start(Robot)
    outcome = asyncio.run(lab.set_parameters("/robot", name="c3po", speed=-0.5, frame="map"))
    assert outcome.reasons["speed"] == "speed must not be negative"
    assert "read-only" in outcome.reasons["frame"]
    assert not outcome.successful
    assert not outcome
    assert str(outcome).splitlines()[:2] == [
        "name: set to 'c3po'",
        "speed: -0.5 was refused: speed must not be negative",
    ]
    assert get("name", "speed", "frame") == {"name": "c3po", "speed": 1.0, "frame": "base"}
    assert lab.set_parameters_blocking("/robot", speed=2.0).successful


def test_atomically_means_all_or_nothing() -> None:
    lab.start(Robot)
    refused = lab.set_parameters_blocking("/robot", atomically=True, name="c3po", gears=4)
    assert not refused
    assert str(refused).startswith(
        "nothing was set, because one value was refused: The parameter value for gears is not a valid"
    )
    assert get("name", "gears") == {"name": "r2d2", "gears": 5}
    assert lab.set_parameters_blocking("/robot", atomically=True, name="c3po", gears=7)
    assert get("name", "gears") == {"name": "c3po", "gears": 7}


def test_an_integer_for_a_double_is_refused_with_what_to_write() -> None:
    lab.start(Robot)
    outcome = lab.set_parameters_blocking("/robot", speed=2)
    assert str(outcome).endswith("2 is an integer: write 2.0")
    assert get("speed") == {"speed": 1.0}


def test_an_undeclared_parameter_is_told_the_nearest_name() -> None:
    lab.start(Robot)
    nearest = r"there is no parameter 'sped': /robot has name, speed, .*late\. Did you mean 'speed'\?"
    with pytest.raises(lab.ParameterNotFoundError, match=f"(?i){nearest}"):
        get("name", "sped")
    outcome = lab.set_parameters_blocking("/robot", sped=1.0, name="c3po")
    assert outcome.reasons.keys() == {"sped"}
    atomic = lab.set_parameters_blocking("/robot", atomically=True, sped=1.0, name="bb8")
    for reason in (outcome.reasons["sped"], atomic.reasons["name"]):
        assert reason.endswith("Did you mean 'speed'?")
    assert get("name") == {"name": "c3po"}


def test_a_node_that_is_not_there_is_told_the_nearest_name() -> None:
    with pytest.raises(lab.NodeNotFoundError, match="nor any other with parameters"):
        lab.get_parameters_blocking("/robot", timeout=0.2)
    lab.start(Robot)
    lab.start(Bare)
    with pytest.raises(lab.NodeNotFoundError, match=r"no node /robt\. The nearest name on the graph is /robot"):
        lab.get_parameters_blocking("/robt", timeout=0.2)
    with pytest.raises(lab.NodeNotFoundError, match=r"no node /x\. On the graph: /robot"):
        asyncio.run(lab.describe_parameters("/x", timeout=0.2))
    with pytest.raises(lab.NodeNotFoundError, match="/bare is on the graph but offers no parameter services"):
        lab.get_parameters_blocking("/bare", timeout=0.2)
    with pytest.raises(lab.LabError, match="7 is not one"):
        lab.get_parameters_blocking(7)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ({}, "a list of one of these; 'speed' was given {}, a dict"),
        ([1, 2.0], r"'speed' was given \[1, 2.0\], a list. Write \[1.0, 2.0\]"),
        ([True, 1], "All elements of a list have one type"),
        (2**63, "An integer parameter has 64 bits; 'speed' was given 9223372036854775808"),
        ([0, -(2**64)], "An integer parameter has 64 bits"),
    ],
)
def test_a_value_no_parameter_can_have_is_an_error(value: Any, message: str) -> None:
    lab.start(Robot)
    with pytest.raises(lab.FieldError, match=message):
        lab.set_parameters_blocking("/robot", speed=value)


def test_names_that_are_no_keywords_are_given_in_a_dict() -> None:
    class Wheels(Node):
        def __init__(self) -> None:
            super().__init__("wheels")
            self.declare_parameter("front.diameter", 0.1)
            self.declare_parameter("timeout", 1.0)

    lab.start(Wheels)
    assert lab.set_parameters_blocking("/wheels", {"front.diameter": 0.2}, timeout=2.0)
    assert lab.get_parameters_blocking("/wheels", "front.diameter", "timeout") == {
        "front.diameter": 0.2,
        "timeout": 2.0,
    }
    with pytest.raises(lab.LabError, match="Say what to set"):
        lab.set_parameters_blocking("/wheels")


@pytest.mark.parametrize("atomically", [False, True])
def test_whoever_listens_for_changes_has_heard_when_set_returns(atomically: bool) -> None:
    lab.start(Robot)
    heard: list[str] = []
    lab.subscribe("/parameter_events", ParameterEvent, lambda event: heard.extend(names(event)))
    lab.subscribe("/parameter_events", ParameterEvent, lambda event: heard.extend(names(event)))
    for speed in (1.5, 2.0, 2.5):
        heard.clear()
        lab.set_parameters_blocking("/robot", atomically=atomically, speed=speed, name="bb8")
        assert sorted(heard) == ["name", "name", "speed", "speed"]
        heard.clear()
        asyncio.run(lab.set_parameters("/robot", atomically=atomically, gears=3))
        assert heard == ["gears", "gears"]
        assert not lab.set_parameters_blocking("/robot", atomically=atomically, gears=4)  # nothing to hear of


def test_a_callback_that_raises_is_an_error_of_the_call() -> None:
    lab.start(Robot)
    with pytest.raises(lab.ServiceFailedError, match="RuntimeError: a bug"):
        lab.set_parameters_blocking("/robot", name="bug")


def test_descriptors_hold_what_the_node_says() -> None:
    lab.start(Robot)
    found = {one.name: one for one in asyncio.run(lab.describe_parameters("/robot"))}
    assert list(found)[:6] == NAMES
    assert found["speed"] == Descriptor(
        "speed", "double", "m/s", Range(-1.0, 5.0, 0.0), read_only=False, constraints=""
    )
    assert found["gears"].range == Range(1, 9, 2)
    assert found["frame"].read_only
    assert str(found["gears"]) == "gears: integer, 1 to 9 in steps of 2\n    odd"
    assert str(lab.describe_parameters_blocking("/robot")).splitlines()[1:3] == [
        "speed: double, -1.0 to 5.0",
        "    m/s",
    ]


def test_a_diagram_shows_a_parameter_by_its_value(own_lab: Lab) -> None:
    own_lab.record()
    lab.start(Robot)
    lab.set_parameters_blocking("/robot", speed=2.0)
    asked = "lab -> robot  /robot/set_parameters request: parameters=[{name='speed', value=2.0}]"
    assert asked in " ".join(str(lab.diagram()).split()).replace("lab -> robot ", "lab -> robot  ")


def test_a_subscription_calls_until_it_is_closed() -> None:
    heard: list[float] = []
    subscription = lab.subscribe("/numbers", Float64, lambda message: heard.append(message.data))
    assert repr(subscription) == "subscription to /numbers [std_msgs/msg/Float64]"
    lab.publish("/numbers", Float64, data=1.0)
    assert heard == [1.0]
    subscription.close()
    subscription.close()
    lab.publish("/numbers", Float64, data=2.0)
    assert heard == [1.0]
    assert repr(subscription).endswith("(closed)")
    assert lab.current().engine.node.count_subscribers("/numbers") == 0


def test_a_subscription_may_be_closed_by_its_own_callback_and_after_the_lab(own_lab: Lab) -> None:
    closed = threading.Event()

    def once(_: Any) -> None:
        first.close()
        closed.set()

    first = lab.subscribe("/numbers", Float64, once)
    second = lab.subscribe("/numbers", Float64, lambda _: None)
    lab.publish("/numbers", Float64, data=1.0)
    assert closed.wait(10)
    own_lab.close()
    second.close()
    assert "(closed)" in repr(second)
