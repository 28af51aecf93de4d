"""The arithmetic of the grader itself: what is right, and what a wrong value tells."""

from __future__ import annotations

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.graders import _limiter
from course_kit.graders._limiter import LimiterSettings, Reaction

velocities = st.floats(-20.0, 20.0)
settings = st.builds(
    LimiterSettings, max_velocity=st.floats(0.01, 5.0), wheel_diameter=st.floats(0.01, 1.0), enabled=st.booleans()
)


@given(settings, velocities, velocities)
def test_the_right_reaction_is_what_the_exercise_asks_for(values: LimiterSettings, speed: float, turn: float) -> None:
    right = _limiter.right_reaction(values, [speed, 0.0, 0.0, 0.0, 0.0, turn])
    if not values.enabled:
        assert right == Reaction((0.0,) * 6, 0.0)
        return
    assert abs(right.fields[0]) <= values.max_velocity
    assert right.fields[0] == speed or abs(speed) > values.max_velocity
    assert right.fields[0] * speed >= 0.0
    assert right.fields[1:] == (0.0, 0.0, 0.0, 0.0, turn)
    assert math.isclose(right.wheel * values.wheel_diameter / 2.0, right.fields[0], abs_tol=1e-12)


@pytest.mark.parametrize(
    ("wheel", "code", "said"),
    [
        (10.0, "math.formula", "divided by the diameter"),
        (0.05, "math.formula", "times the radius"),
        (1.0 / (math.pi * 0.1), "math.formula", "turns per second"),
        (60.0, "math.formula", "the command that came in"),
        (-20.0, "math.formula", "sign"),
        (1.0, "math.formula", "in m/s"),
        (17.3, "math.formula", "none of the usual mistakes"),
        (21.0, "math.integer_division", "Digits were lost"),
    ],
)
def test_a_wrong_wheel_speed_is_explained(wheel: float, code: str, said: str) -> None:
    got = Reaction((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), wheel)
    breaks, diagnosis, message = _limiter.cause_of(LimiterSettings(), [3.0, 0.0, 0.0, 0.0, 0.0, 0.0], got, floors=False)
    assert (breaks, diagnosis, said in message) == ("wheel_speed", code, True)


@pytest.mark.parametrize(
    ("name", "reason", "lacks"),
    [
        ("max_velocity", "", "empty"),
        ("max_velocity", "  ", "empty"),
        ("max_velocity", "out of range 0 .. 5", "name the parameter"),
        ("max_velocity", "max_velocity must be positive", "as a number"),
        ("max_velocity", "max_velocity=-1.0 is not allowed", "as a number"),
        ("max_velocity", "max_velocity is at most 5.0", "as a number"),
        ("max_velocity", "max_velocity muss groesser als 0 und hoechstens 5 sein", ""),
        ("max_velocity", "Parameter max_velocity out of range Min: 0.0, Max: 5.0, value: 7.2", ""),
        ("wheel_diameter", "wheel_diameter: 1e-2 .. 1", ""),
        ("robot_name", "robot_name must not be empty", ""),
        ("robot_name", "empty", "name the parameter"),
    ],
)
def test_what_a_reason_lacks(name: str, reason: str, lacks: str) -> None:
    told = _limiter.missing_in_reason(name, "" if name == "robot_name" else 7.2 if "7.2" in reason else -1.0, reason)
    assert bool(told) == bool(lacks)
    assert lacks in told


@given(
    st.lists(st.sampled_from(["a", ":", " ", "\n", "1", ".", "m/s", "m", "/s", "\t", "\u2028"]), max_size=12).map(
        "".join
    )
)
def test_a_status_line_is_read_as_the_exercise_describes_it(line: str) -> None:
    """The name is all before the last colon, blanks too."""
    match = re.fullmatch(r"(?P<name>.*):(?P<number>[^:]*)m/s\s*", line, re.DOTALL)
    try:
        expected = (match["name"], float(match["number"])) if match else None
    except ValueError:
        expected = None
    assert _limiter.read_status(line) == expected
