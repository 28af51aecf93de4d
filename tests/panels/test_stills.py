"""What an export of a notebook shows of each panel: a picture that needs no kernel, no script and no network."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import pytest
from course_interfaces.action import MoveRobot
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from std_msgs.msg import Float64

from course_kit import lab, panels, quiz
from course_kit.panels.plotting import plot_svg
from tests.waiting import wait_until

if TYPE_CHECKING:
    from course_kit.panels.base import Panel

pytestmark = pytest.mark.usefixtures("live_lab")


def still(panel: Panel) -> str:
    """As it is stored with a notebook; the same twice."""
    html = str(panel._repr_mimebundle_()["text/html"])
    assert html == panel.still()
    assert not re.findall(r"https?:|<script|url\(|@import|<input|<button", html)
    return html


def test_a_form_shows_its_fields_with_what_is_in_them() -> None:
    form = panels.service_form("/add_two_ints", AddTwoInts)
    form.fill({"a": "20"})
    html = still(form)
    assert re.findall(r'<code class="ck-entry">(.*?)</code>', html) == ["20", "0"]
    assert '<span class="ck-button">Send request</span>' in html
    assert "int64: a whole number" in html


def test_a_panel_for_goals_shows_the_goal() -> None:
    panel = panels.action_panel("/move_robot", MoveRobot)
    panel.fill({"target.x": "1.5"})
    html = still(panel)
    assert re.findall(r'<code class="ck-entry">(.*?)</code>', html)[0] == "1.5"
    assert '<span class="ck-button">Cancel goal</span>' in html


def test_sliders_show_their_values() -> None:
    class Robot(Node):
        def __init__(self) -> None:
            super().__init__("robot")
            limits = FloatingPointRange(from_value=0.0, to_value=4.0)
            self.declare_parameter("speed", 1.0, ParameterDescriptor(description="m/s", floating_point_range=[limits]))
            self.declare_parameter("<lights>", True)

    lab.start(Robot)
    html = still(panels.parameter_sliders("/robot"))
    assert '<circle cx="54" cy="10" r="7"/>' in html  # a quarter of the way from 8 to 192
    assert '<code class="ck-entry">1.0</code>' in html
    assert "&lt;lights&gt;" in html
    assert "<code>true</code>" in html


def test_a_map_shows_what_is_known_of_the_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    from course_kit.panels.demo_robot import DemoRobot

    monkeypatch.setenv("COURSE_KIT_TIME_SCALE", "0.05")
    lab.start(DemoRobot)
    drawn: Any = panels.robot_map()
    assert 'cx="0.0" cy="0.0"' in still(drawn)
    drawn.go(2.0, 1.5)
    wait_until(lambda: "SUCCEEDED" in drawn.widget.view["line"])
    html = still(drawn)
    assert '<circle class="ck-robot" cx="2.0" cy="1.5" r="0.28"/>' in html
    assert 'd="M1.5 1.5h1M2.0 1.0v1"' in html
    assert "SUCCEEDED" in html


def test_a_plot_shows_what_has_come() -> None:
    plot = panels.plot("/speed", Float64, "data")
    assert "no message yet" in still(plot)
    for value in (1.0, 2.0, float("nan"), 3.0):
        lab.publish("/speed", Float64, data=value)
    html = still(plot)
    assert "no message yet" not in html
    assert "The latest value is 3." in html


@pytest.mark.parametrize(
    ("samples", "line"),
    [
        ([], ""),
        ([[0.0, 5.0]], "M626.0 106.0"),
        ([[0.0, 0.0], [1.0, 4.0], [2.0, 2.0]], "M569.2 200.0L597.6 12.0L626.0 106.0"),
        ([[0.0, 0.0], [0.1, 4.0], [0.2, 4.0], [5.0, 0.0]], "M484.0 200.0L486.8 12.0L489.7 12.0M626.0 200.0"),  # silence
        ([[0.0, 0.0], [0.1, float("inf")], [0.2, 4.0]], "M620.3 200.0M626.0 12.0"),
    ],
)
def test_the_line_of_a_plot_goes_through_what_is_known(samples: list[list[float]], line: str) -> None:
    assert f'<path class="ck-way" d="{line}"/>' in plot_svg(samples, 20.0, "data")


def test_a_plot_of_values_that_doubles_hardly_tell_apart_has_an_axis() -> None:
    drawing = plot_svg([[0.0, 1.0], [0.1, 1.0 + 2.3e-16], [0.2, 1.0 + 4.5e-16]], 20.0, "data")
    assert re.findall(r">([\d.]+)</text>", drawing)[:5] == ["0.8", "0.9", "1", "1.1", "1.2"]


def test_the_quiz_shows_its_first_scenario_and_then_what_was_chosen_with_its_marks() -> None:
    panel = panels.quiz()
    scenario = quiz.show().scenarios[0]
    assert scenario.title in still(panel)
    assert still(panel).count("<li>") == len(scenario.reasons)
    pattern, reasons = next(iter(scenario.accepted.items()))
    panel.answer(scenario.id, pattern, reasons[0])
    html = still(panel)
    panel.reset()
    assert scenario.reasons[reasons[0]] in html
    assert f"{pattern} <b>✓</b>" in html
