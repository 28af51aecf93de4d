"""Sliders for a real node: what they are made of, what they set, what they hear."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node

from course_kit import lab, panels
from course_kit.lab.parameters import Range
from course_kit.panels.sliders import format_value, slider_step
from tests.waiting import wait_until

if TYPE_CHECKING:
    from rclpy.parameter import Parameter

pytestmark = pytest.mark.usefixtures("live_lab")


class Robot(Node):
    """Has one parameter for each kind of widget."""

    def __init__(self) -> None:
        super().__init__("robot")
        limits = FloatingPointRange(from_value=0.0, to_value=5.0)
        self.declare_parameter("speed", 1.0, ParameterDescriptor(description="m/s", floating_point_range=[limits]))
        steps = IntegerRange(from_value=1, to_value=9, step=2)
        self.declare_parameter("gears", 5, ParameterDescriptor(integer_range=[steps]))
        self.declare_parameter("lights", True)
        self.declare_parameter("name", "r2d2")
        self.declare_parameter("mass", 12.5)
        self.declare_parameter("frame", "base", ParameterDescriptor(read_only=True))
        self.declare_parameter("route", [1.0, 2.5])
        self.add_on_set_parameters_callback(self.judge)

    def judge(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == "speed" and parameter.value == 4.0:
                return SetParametersResult(successful=False, reason="4.0 makes the robot rattle")
        return SetParametersResult(successful=True)


def in_force(name: str) -> Any:
    return lab.get_parameters_blocking("/robot", name)[name]


def wish(panel: Any, name: str, value: Any, token: int = 1) -> None:
    """What the page does."""
    panel.widget._handle_custom_msg({"name": name, "value": value, "token": token}, [])


def test_each_parameter_of_the_nodes_own_gets_the_widget_that_fits_it() -> None:
    lab.start(Robot)
    widget = panels.parameter_sliders("/robot").widget
    kinds = {one["name"]: one["kind"] for one in widget.entries}
    expected = {"speed": "slider", "gears": "slider", "lights": "flag", "name": "text", "mass": "number"}
    assert kinds == {**expected, "frame": "text", "route": "text"}
    speed = widget.entries[0]
    assert (speed["lowest"], speed["highest"], speed["step"], speed["description"]) == (0.0, 5.0, 0.05, "m/s")
    notes = [one["name"] for one in widget.entries if "read-only" in one["note"]]
    assert notes == ["frame"]
    assert widget.values["speed"] == "1.0"
    assert widget.values["route"] == "[1.0, 2.5]"
    assert widget.values["lights"] is True


def test_it_is_described_in_words_and_may_be_given_the_node_itself() -> None:
    panel = panels.parameter_sliders(lab.start(Robot))
    text = panel._repr_mimebundle_()["text/plain"]
    assert text.splitlines()[:3] == [
        "Sliders and boxes that set the parameters of /robot:",
        "  speed = 1.0 (double, 0.0 to 5.0)",
        "  gears = 5 (integer, 1 to 9 in steps of 2)",
    ]


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("speed", "2.5", 2.5),
        ("speed", "2", 2.0),
        ("gears", "7", 7),
        ("lights", False, False),
        ("name", "c3po", "c3po"),
        ("mass", "1e3", 1000.0),
        ("route", "[1, 2]", [1.0, 2.0]),
        ("route", "[]", []),
    ],
)
def test_what_is_moved_or_typed_sets_the_real_parameter(name: str, text: Any, value: Any) -> None:
    lab.start(Robot)
    panel = panels.parameter_sliders("/robot")
    wish(panel, name, text, token=7)
    assert in_force(name) == value
    assert panel.widget.values[name] == format_value(value)
    assert panel.widget.outcomes[name] == {"state": "set", "text": "", "token": 7}


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("speed", "4.0", "4.0 makes the robot rattle"),
        ("speed", "9", "out of range"),
        ("speed", "fast", "'fast' is not a number such as 1.5."),
        ("gears", "2.5", "'2.5' is not a whole number such as 3."),
        ("gears", "4", "not a valid step"),
        ("frame", "map", "read-only"),
        ("route", "[1, x]", "'[1, x]' is not a list such as [1.0, 2.5]."),
        ("route", "1", "is not a list"),
    ],
)
def test_a_refusal_is_shown_with_its_reason_and_the_value_in_force_stays(name: str, text: str, reason: str) -> None:
    lab.start(Robot)
    panel = panels.parameter_sliders("/robot")
    before = dict(panel.widget.values)
    wish(panel, name, text)
    outcome = panel.widget.outcomes[name]
    assert outcome["state"] == "refused"
    assert reason in outcome["text"]
    assert panel.widget.values == before
    assert format_value(in_force(name)) == before[name]


def test_a_node_that_has_gone_is_said_beside_the_widget() -> None:
    lab.start(Robot)
    panel = panels.parameter_sliders("/robot")
    lab.stop("robot")
    assert panel.set("speed", "2.0") is False
    outcome = panel.widget.outcomes["speed"]
    assert (outcome["state"], "There is no node /robot" in outcome["text"]) == ("failed", True)


def test_a_change_made_elsewhere_is_shown_and_one_of_another_node_is_not() -> None:
    class Other(Robot):
        def __init__(self) -> None:
            Node.__init__(self, "other")
            self.declare_parameter("speed", 1.0)

    lab.start(Robot)
    lab.start(Other)
    panel = panels.parameter_sliders("/robot")
    lab.set_parameters_blocking("/robot", speed=2.0)
    wait_until(lambda: panel.widget.values["speed"] == "2.0")
    lab.set_parameters_blocking("/other", speed=3.0)  # returns when the panel has had the news
    assert panel.values["speed"] == 2.0
    assert panel.widget.outcomes["speed"]["state"] == "elsewhere"
    assert panel.describe().splitlines()[1] == "  speed = 2.0 (double, 0.0 to 5.0)"


def test_a_node_started_again_with_other_parameters_is_drawn_anew() -> None:
    class Robot(Node):
        def __init__(self, name: str, value: float) -> None:
            super().__init__("robot")
            self.declare_parameter(name, value)

    lab.start(Robot, "speed", 1.0)
    panel = panels.parameter_sliders("/robot")
    lab.start(Robot, "height", 2.0)
    wait_until(lambda: panel.widget.values == {"height": "2.0"})
    assert [one["name"] for one in panel.widget.entries] == ["height"]


def test_after_its_end_nothing_is_heard_and_nothing_is_set() -> None:
    lab.start(Robot)
    panel = panels.parameter_sliders("/robot")
    looking = lab.current().engine.node
    assert looking.count_subscribers("/parameter_events") == 1
    again = panels.parameter_sliders("/robot")
    assert looking.count_subscribers("/parameter_events") == 1
    assert "Run their cell again" in panel.widget.ended
    wish(panel, "speed", "3.0")
    assert in_force("speed") == 1.0
    again.close()
    assert looking.count_subscribers("/parameter_events") == 0


def test_no_node_no_sliders_and_the_ones_before_go_on() -> None:
    lab.start(Robot)
    panel = panels.parameter_sliders("/robot")
    with pytest.raises(lab.NodeNotFoundError, match="The nearest name on the graph is /robot"):
        panels.parameter_sliders("/robto")
    wish(panel, "speed", "3.0")
    assert in_force("speed") == 3.0


@pytest.mark.parametrize(
    ("limits", "whole", "step"),
    [
        (Range(0.0, 5.0, 0.0), False, 0.05),
        (Range(0.01, 1.0, 0.0), False, 0.005),
        (Range(-1.0, 1.0, 0.25), False, 0.25),
        (Range(0.0, 0.3, 0.0), False, 0.002),
        (Range(0.0, 1.0005, 0.0), False, 0.010005),
        (Range(1, 9, 2), True, 2),
        (Range(0, 10, 0), True, 1),
        (Range(0, 100_000, 0), True, 1000),
    ],
)
def test_a_slider_has_round_steps_that_reach_its_upper_limit(limits: Range, whole: bool, step: float) -> None:
    found = slider_step(limits, whole=whole)
    assert found == pytest.approx(step)
    count = (limits.highest - limits.lowest) / found
    assert count == pytest.approx(round(count))
