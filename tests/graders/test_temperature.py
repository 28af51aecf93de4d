"""The arithmetic of exercise 1's grader, and the mistakes it recognises."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.graders._temperature import CELSIUS, FAHRENHEIT, Sample, explain, fits, right_value

if TYPE_CHECKING:
    from collections.abc import Callable

VALUES = (0.0, 37.0, -40.0, 21.5, 98.6)


@pytest.mark.parametrize(("celsius", "fahrenheit"), [(0, 32), (100, 212), (-40, -40), (37, 98.6), (-273.15, -459.67)])
def test_textbook_values(celsius: float, fahrenheit: float) -> None:
    assert right_value(Sample(celsius, CELSIUS, FAHRENHEIT)) == pytest.approx(fahrenheit, abs=1e-9)
    assert right_value(Sample(fahrenheit, FAHRENHEIT, CELSIUS)) == pytest.approx(celsius, abs=1e-9)
    assert right_value(Sample(celsius, CELSIUS, CELSIUS)) == celsius


@given(st.floats(-273.15, 1e9))
def test_there_and_back(value: float) -> None:
    there = right_value(Sample(value, CELSIUS, FAHRENHEIT))
    assert math.isclose(right_value(Sample(there, FAHRENHEIT, CELSIUS)), value, rel_tol=1e-9, abs_tol=1e-9)


@pytest.mark.parametrize(
    ("got", "right"), [(212.0 * (1 + 9e-7), True), (212.0 * (1 + 2e-6), False), (math.nan, False), (math.inf, False)]
)
def test_tolerance_is_relative(got: float, right: bool) -> None:
    assert fits(Sample(100.0, CELSIUS, FAHRENHEIT), got) == right


def test_tolerance_is_absolute_near_zero() -> None:
    freezing = Sample(32.0, FAHRENHEIT, CELSIUS)
    assert fits(freezing, 9e-10)
    assert not fits(freezing, 2e-9)


@pytest.mark.parametrize(
    ("unit", "formula", "code", "floors"),
    [
        (CELSIUS, lambda v: v * (9 // 5) + 32, "math.integer_division", False),
        (CELSIUS, lambda v: float(int(v * 9 / 5 + 32)), "math.integer_division", False),
        (CELSIUS, lambda v: round(v * 9 / 5 + 32, 2) + 0.001, "math.integer_division", False),
        (CELSIUS, lambda v: v * 9 / 5, "math.formula", False),
        (CELSIUS, lambda v: (v - 32) * 5 / 9, "math.formula", False),
        (CELSIUS, lambda v: v, "math.formula", False),
        (CELSIUS, lambda v: 2 * v + 30, "math.formula", False),
        (CELSIUS, lambda _: math.nan, "math.formula", False),
        (CELSIUS, lambda _: 4e-323, "field.type", False),
        (FAHRENHEIT, lambda _: 0.0, "math.integer_division", True),
        (FAHRENHEIT, lambda _: 0.0, "math.formula", False),
        (FAHRENHEIT, lambda v: v - 32 * 5 / 9, "math.formula", False),
        (FAHRENHEIT, lambda v: (v - 32) // 9 * 5 + 1.5, "math.formula", False),
    ],
)
def test_mistakes_are_told_apart(unit: str, formula: Callable[[float], float], code: str, floors: bool) -> None:
    other = FAHRENHEIT if unit == CELSIUS else CELSIUS
    answers = [(Sample(value, unit, other), formula(value)) for value in VALUES]
    found, told = explain(answers, floors=floors)
    assert found == code
    assert told
