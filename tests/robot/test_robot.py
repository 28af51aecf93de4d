from __future__ import annotations

import math
import threading
import time

import pytest

from course_kit.robot import SimulatedRobot


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> SimulatedRobot:
    monkeypatch.setenv("COURSE_KIT_TIME_SCALE", "0")
    return SimulatedRobot()


def drive(robot: SimulatedRobot, x: float, y: float) -> int:
    steps = 0
    while robot.position != (x, y):
        robot.step_towards(x, y)
        steps += 1
        assert steps < 1000, "it never arrives"
    return steps


def test_a_step_is_five_centimetres_straight_at_the_target(robot: SimulatedRobot) -> None:
    robot.step_towards(3.0, 4.0)
    assert robot.position == pytest.approx((0.03, 0.04))


@pytest.mark.parametrize(("x", "y", "steps"), [(1.0, 0.0, 20), (0.0, 10.0, 200), (3.0, 4.0, 100), (0.12, 0.0, 3)])
def test_a_metre_takes_twenty_steps_and_the_last_ends_on_the_target(
    robot: SimulatedRobot, x: float, y: float, steps: int
) -> None:
    assert drive(robot, x, y) == steps


def test_it_never_drives_past_its_target(robot: SimulatedRobot) -> None:
    left = [1.0]
    while robot.position.x < 0.99:
        robot.step_towards(0.99, 0.0)
        left.append(0.99 - robot.position.x)
    assert min(left) == 0.0
    robot.step_towards(0.99, 0.0)
    assert robot.position == (0.99, 0.0)


def test_the_way_stays_on_the_straight_line(robot: SimulatedRobot) -> None:
    drive(robot, 2.0, 1.0)
    while robot.position != (1.0, 4.0):
        robot.step_towards(1.0, 4.0)
        x, y = robot.position
        assert abs(3.0 * (x - 2.0) + (y - 1.0)) < 1e-6


@pytest.mark.parametrize("target", [(0.0, 0.0), (10.0, 10.0), (0.0, 10.0), (10, 0)])
def test_the_walls_belong_to_the_arena(robot: SimulatedRobot, target: tuple[float, float]) -> None:
    drive(robot, *target)
    assert robot.position == target


@pytest.mark.parametrize(
    ("x", "y", "told"),
    [
        (10.01, 5.0, "x = 10.01 m is outside the arena"),
        (5.0, -0.01, "y = -0.01 m is outside the arena"),
        (math.inf, 0.0, "x = inf m is outside the arena"),
        (0.0, math.nan, "y is NaN"),
    ],
)
def test_targets_that_are_no_place_are_refused_and_move_nothing(
    robot: SimulatedRobot, x: float, y: float, told: str
) -> None:
    with pytest.raises(ValueError, match=told):
        robot.step_towards(x, y)
    assert robot.position == (0.0, 0.0)


@pytest.mark.parametrize("wrong", ["1.0", None, (1.0, 2.0), object()])
def test_what_is_no_number_is_refused_with_the_right_way_to_call(robot: SimulatedRobot, wrong: object) -> None:
    with pytest.raises(TypeError, match=r"step_towards\(p\.x, p\.y\)"):
        robot.step_towards(wrong, 1.0)  # type: ignore[arg-type]


def test_the_time_scale_stretches_the_waiting_and_not_the_way(monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[float] = []
    monkeypatch.setattr(time, "sleep", waits.append)
    for scale in (None, "0.1", "2"):
        if scale is None:
            monkeypatch.delenv("COURSE_KIT_TIME_SCALE", raising=False)
        else:
            monkeypatch.setenv("COURSE_KIT_TIME_SCALE", scale)
        robot = SimulatedRobot()
        robot.step_towards(1.0, 0.0)
        assert robot.position == (0.05, 0.0)
    assert waits == pytest.approx([0.05, 0.005, 0.1])


def test_steps_from_two_threads_all_count(robot: SimulatedRobot) -> None:
    def fifty_steps() -> None:
        for _ in range(50):
            robot.step_towards(10.0, 0.0)

    threads = [threading.Thread(target=fifty_steps) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert robot.position == pytest.approx((5.0, 0.0))
