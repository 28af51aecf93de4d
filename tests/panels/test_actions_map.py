"""The map of the arena, with real goals for the robot of lesson 2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from course_kit import lab, panels
from course_kit.panels.demo_robot import DemoRobot
from tests.waiting import wait_until

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab
    from course_kit.panels.arena_map import RobotMap


@pytest.fixture(autouse=True)
def in_a_hurry(own_lab: Lab, monkeypatch: pytest.MonkeyPatch) -> None:
    assert own_lab
    monkeypatch.setenv("COURSE_KIT_TIME_SCALE", "0.05")


@pytest.fixture
def robot() -> DemoRobot:
    return lab.start(DemoRobot)


def view(drawn: RobotMap) -> dict[str, Any]:
    return dict(drawn.widget.view)


def wish(drawn: RobotMap, **content: Any) -> None:
    drawn.widget._handle_custom_msg(content, [])


def expect(drawn: RobotMap, words: str) -> dict[str, Any]:
    wait_until(lambda: words in view(drawn)["line"], lambda: view(drawn))
    return view(drawn)


def test_it_shows_a_robot_only_where_the_robot_is(robot: DemoRobot) -> None:
    goal = lab.send_goal_blocking("/move_robot", robot._type, target={"x": 1.0, "y": 0.5})
    assert goal.result_blocking().distance_travelled == pytest.approx(1.5)
    drawn = panels.robot_map()
    shown = view(drawn)
    assert (shown["track"], shown["target"], shown["running"]) == ([[1.0, 0.5]], [], False)
    assert shown["line"].endswith("that sends a goal to /move_robot. The robot was last seen at (1.0, 0.5).")
    lab.send_goal_blocking("/move_robot", robot._type, target={"x": 0.5, "y": 0.0}).result_blocking()
    expect(drawn, "The robot was last seen at (0.5, 0.0).")
    lab.stop()  # it may run elsewhere, and anywhere
    unknown = view(panels.robot_map())
    assert unknown["track"] == []
    assert "as soon as it sends feedback" in unknown["line"]


def test_a_click_drives_the_robot_and_draws_its_way(robot: DemoRobot) -> None:
    drawn = panels.robot_map()
    wish(drawn, do="go", x=2, y=1.5)
    shown = expect(drawn, "SUCCEEDED")
    assert shown["track"][0] == [0.0, 0.0]
    assert shown["track"][-1] == [2.0, 1.5] == list(robot._robot.position)
    assert len(shown["track"]) > 2  # around the corner
    assert shown["tone"] == "good"
    assert "The robot came to (2.0, 1.5). Its message: arrived." in shown["line"]
    lab.send_goal_blocking("/move_robot", robot._type, target={"x": 1.0, "y": 1.5}).result_blocking()  # not from here
    wait_until(lambda: view(drawn)["track"][-1] == [1.0, 1.5], lambda: view(drawn))


@pytest.mark.usefixtures("robot")
def test_it_tells_on_the_way_where_the_robot_is_and_how_far_it_has_to_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COURSE_KIT_TIME_SCALE", "1")
    lab.start(DemoRobot)
    drawn = panels.robot_map()
    wish(drawn, do="go", x=9.0, y=9.0)
    shown = expect(drawn, "m to go")
    assert shown["running"]
    assert shown["target"] == [9.0, 9.0]
    assert shown["line"].startswith("The goal (9.0, 9.0) is running (EXECUTING). Position (")
    assert shown["said"] == "The goal (9.0, 9.0) is running (EXECUTING)."  # for a screen reader: no metres
    wish(drawn, do="go", x=1.0, y=1.0)
    shown = expect(drawn, "REJECTED")
    assert "The goal (1.0, 1.0) was rejected by the server (REJECTED). The robot is busy" in shown["said"]
    assert (shown["running"], shown["target"]) == (True, [9.0, 9.0])
    wish(drawn, do="cancel")
    shown = expect(drawn, "CANCELED")
    assert "stopped on the way" in shown["line"]
    assert 0.0 < shown["track"][-1][0] < 9.0


@pytest.mark.usefixtures("robot")
@pytest.mark.parametrize(("x", "y"), [(12.0, 3.0), (3.0, -0.5)])
def test_a_goal_outside_is_rejected_by_the_server_and_the_reason_is_said(x: float, y: float) -> None:
    drawn = panels.robot_map()
    wish(drawn, do="go", x=x, y=y)
    shown = expect(drawn, "REJECTED")
    assert "It lies outside the arena, which goes from 0 to 10 m." in shown["line"]
    assert (shown["tone"], shown["track"]) == ("bad", [[0.0, 0.0]])


def test_a_map_again_ends_the_one_before(robot: DemoRobot) -> None:
    first = panels.robot_map()
    wish(first, do="go", x=9.0, y=9.0)
    wait_until(lambda: view(first)["running"], lambda: view(first))
    panels.robot_map()
    assert robot._free.acquire(timeout=30)  # the first one's goal is cancelled
    assert robot._robot.position != (9.0, 9.0)
    wish(first, do="go", x=1.0, y=1.0)
    assert (view(first)["ended"], view(first)["running"], view(first)["target"]) == (True, False, [9.0, 9.0])
