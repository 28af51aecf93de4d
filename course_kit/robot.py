"""The robot of exercise 2: a point that drives through a square arena, one control period at a time.

It knows nothing of ROS 2, as a motor driver does not: the node around it does the talking.
"""

from __future__ import annotations

import math
import os
import threading
import time
from typing import NamedTuple, SupportsFloat

_TIME_SCALE = "COURSE_KIT_TIME_SCALE"
_ROUNDING = 1e-9  # metres; how far a sum of floats may lie beyond a wall, or a step short of its target


class Position(NamedTuple):
    """A place in the arena, in metres."""

    x: float
    y: float


class SimulatedRobot:
    """A robot that starts at (0, 0) and drives at 1 m/s through an arena of 10 m x 10 m.

    Attributes:
        ARENA_SIZE: length of the arena's sides in metres: 0 <= x <= 10 and 0 <= y <= 10.
        SPEED: metres a second.
        CONTROL_PERIOD: seconds one step takes.

    The environment variable COURSE_KIT_TIME_SCALE makes the waiting shorter or longer (0.1: ten times as fast);
    the way a step covers stays the same.
    """

    ARENA_SIZE = 10.0
    SPEED = 1.0
    CONTROL_PERIOD = 0.05

    def __init__(self) -> None:
        """Put a robot into the arena.

        Raises:
            ValueError: COURSE_KIT_TIME_SCALE is set to something that is no time scale.
        """
        self._position = Position(0.0, 0.0)
        self._wait_s = self.CONTROL_PERIOD * _time_scale()
        self._lock = threading.Lock()

    @property
    def position(self) -> Position:
        """Where the robot is now, in metres."""
        return self._position

    def step_towards(self, x: float, y: float) -> None:
        """Drive straight towards (x, y) for one control period, and wait until it is over.

        One step is 0.05 m, the last one what is left: the robot never drives past its target. At the target it stands
        still for the period. The call blocks for 0.05 s.

        Args:
            x: where to, in metres, 0 to 10.
            y: where to, in metres, 0 to 10.

        Raises:
            TypeError: x or y is no number.
            ValueError: x or y is NaN, or lies outside the arena.
        """
        target = Position(_coordinate("x", x), _coordinate("y", y))
        with self._lock:  # two threads that step together drive twice as fast, but lose no step
            self._position = _next_position(self._position, target, self.SPEED * self.CONTROL_PERIOD)
        time.sleep(self._wait_s)

    def __repr__(self) -> str:
        return f"<SimulatedRobot at ({self._position.x:.2f}, {self._position.y:.2f})>"


def _next_position(here: Position, target: Position, step: float) -> Position:
    distance = math.dist(here, target)
    if distance <= step + _ROUNDING:
        return target
    share = step / distance
    return Position(here.x + share * (target.x - here.x), here.y + share * (target.y - here.y))


def _coordinate(name: str, value: object) -> float:
    """One coordinate of a target, checked."""
    if not isinstance(value, SupportsFloat):
        raise TypeError(
            f"step_towards takes two numbers in metres, but {name} is a {type(value).__name__}. "
            f"With a geometry_msgs Point p: robot.step_towards(p.x, p.y)."
        )
    number = float(value)
    size = SimulatedRobot.ARENA_SIZE
    if math.isnan(number):
        raise ValueError(f"{name} is NaN, not a place to drive to. Check the target with math.isfinite() first.")
    if not -_ROUNDING <= number <= size + _ROUNDING:
        raise ValueError(
            f"{name} = {number:g} m is outside the arena, which goes from 0 to {size:g} m. "
            f"Refuse such a target before you drive."
        )
    return min(max(number, 0.0), size)


def _time_scale() -> float:
    text = os.environ.get(_TIME_SCALE, "1")
    try:
        scale = float(text)
    except ValueError:
        scale = math.nan
    if not (math.isfinite(scale) and scale >= 0.0):
        raise ValueError(f"{_TIME_SCALE} is '{text}', but it must be a number from 0 up; 1 is real time. Unset it.")
    return scale
