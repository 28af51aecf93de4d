"""The arithmetic of exercise 1's grader, and the mistakes it recognises."""

from __future__ import annotations

import itertools
import math
import random
from types import SimpleNamespace
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.graders.temperature_service import (
    CELSIUS,
    FAHRENHEIT,
    Sample,
    Temperatures,
    explain_answers,
    has_every_digit,
    has_right_formula,
    right_value,
)
from course_kit.grading.checks.answers import Answer
from course_kit.grading.checks.evidence import ExchangeLog, Failed
from course_kit.grading.checks.steps import Step, Steps, rules_of

if TYPE_CHECKING:
    from collections.abc import Callable

VALUES = (0.0, 37.0, -40.0, 21.5, 98.6)


@pytest.mark.parametrize(("celsius", "fahrenheit"), [(0, 32), (100, 212), (-40, -40), (37, 98.6), (-273.15, -459.67)])
def test_textbook_values(celsius: float, fahrenheit: float) -> None:
    assert right_value(Sample(celsius, CELSIUS, FAHRENHEIT)) == pytest.approx(fahrenheit, abs=1e-9)
    assert right_value(Sample(fahrenheit, FAHRENHEIT, CELSIUS)) == pytest.approx(celsius, abs=1e-9)
    assert right_value(Sample(celsius, CELSIUS, CELSIUS)) == celsius


@pytest.mark.parametrize(
    ("got", "right"), [(212.0 * (1 + 9e-7), True), (212.0 * (1 + 2e-6), False), (math.nan, False), (math.inf, False)]
)
def test_tolerance_is_relative(got: float, right: bool) -> None:
    assert has_right_formula(Sample(100.0, CELSIUS, FAHRENHEIT), got) == right


FORMULAS: dict[str, tuple[Callable[[float], float], ...]] = {
    CELSIUS: (
        lambda v: v * 9 / 5 + 32,
        lambda v: v * 1.8 + 32,
        lambda v: 9 * v / 5 + 32,
        lambda v: (v + 273.15) * 9 / 5 - 459.67,
        lambda v: (v + 40) * 1.8 - 40,
    ),
    FAHRENHEIT: (
        lambda v: (v - 32) * 5 / 9,
        lambda v: (v - 32) / 1.8,
        lambda v: (v - 32) * (5 / 9),
        lambda v: (v + 459.67) * 5 / 9 - 273.15,
        lambda v: (v + 40) / 1.8 - 40,
    ),
}


@pytest.mark.parametrize(("unit", "other"), [(CELSIUS, FAHRENHEIT), (FAHRENHEIT, CELSIUS)])
@given(value=st.floats(-459.0, 1e9))
def test_every_usual_formula_is_exact_and_a_bit_more_is_wrong(unit: str, other: str, value: float) -> None:
    sample = Sample(value, unit, other)
    assert [has_every_digit(sample, formula(value)) for formula in FORMULAS[unit]] == [True] * len(FORMULAS[unit])
    assert not has_every_digit(sample, right_value(sample) + 3e-12 * max(1.0, abs(right_value(sample))))


@pytest.mark.parametrize("unit", [CELSIUS, FAHRENHEIT])
def test_the_same_unit_is_exact_to_the_last_bit(unit: str) -> None:
    sample = Sample(0.1, unit, unit)
    assert has_every_digit(sample, 0.1)
    assert not has_every_digit(sample, math.nextafter(0.1, 1.0))
    code, told = explain_answers([(sample, math.nextafter(0.1, 1.0))], floors=False, rounds=False)
    assert (code, "calculated or rounded" in told) == ("math.formula", True)


@pytest.mark.parametrize(
    ("unit", "formula", "code", "has"),
    [
        (CELSIUS, lambda v: v * (9 // 5) + 32, "math.integer_division", ""),
        (CELSIUS, lambda v: float(int(v * 9 / 5 + 32)), "math.integer_division", "rounds"),
        (CELSIUS, lambda v: round(v * 9 / 5 + 32, 2) + 0.001, "math.formula", ""),
        (CELSIUS, lambda v: v * 9 / 5, "math.formula", ""),
        (CELSIUS, lambda v: (v - 32) * 5 / 9, "math.formula", ""),
        (CELSIUS, lambda v: v, "math.formula", ""),
        (CELSIUS, lambda v: 2 * v + 30, "math.formula", ""),
        (CELSIUS, lambda _: math.nan, "math.formula", ""),
        (CELSIUS, lambda _: 4e-323, "field.type", ""),
        (FAHRENHEIT, lambda _: 0.0, "math.integer_division", "floors"),
        (FAHRENHEIT, lambda _: 0.0, "math.formula", ""),
        (FAHRENHEIT, lambda v: v - 32 * 5 / 9, "math.formula", ""),
        (FAHRENHEIT, lambda v: (v - 32) // 9 * 5 + 1.5, "math.formula", ""),
    ],
)
def test_mistakes_are_told_apart(unit: str, formula: Callable[[float], float], code: str, has: str) -> None:
    other = FAHRENHEIT if unit == CELSIUS else CELSIUS
    answers = [(Sample(value, unit, other), formula(value)) for value in VALUES]
    found, told = explain_answers(answers, floors=has == "floors", rounds=has == "rounds")
    assert found == code
    assert told


def test_each_kind_of_request_comes_after_each_other() -> None:
    """What a program keeps of one request shows in the next: hardly a conversation lacks one of the pairs."""
    model, missing = Temperatures(), 0
    for seed in range(50):
        steps = Steps(rules_of(Temperatures), random.Random(seed))  # noqa: S311 - no secrets
        done: list[Step] = []
        for _ in range(steps.round):
            done.append(steps.draw_step(model, done, apart=False))
        kinds = [step.kind for step in done]
        each = {kind for kind in kinds if kind != ("ask_fifty",)}
        missing += len(set(itertools.product(each, each)) - set(itertools.pairwise(kinds)))
        assert len(each) == 11
    assert missing <= 2


@pytest.mark.parametrize("others_answered", [True, False])
def test_a_refusal_costs_what_is_hot_or_cold_only_where_others_are_answered(others_answered: bool) -> None:
    answer = Answer("", "", response=SimpleNamespace(success=others_answered))
    node = SimpleNamespace(call=lambda *_: answer, context=SimpleNamespace(record=ExchangeLog()))
    blamed = [Temperatures().blame_refusal(node, Sample(value, CELSIUS, CELSIUS)) for value in (-273.0, 1e5, 20.0)]
    assert blamed == (["absolute_zero", "every_digit", "same_unit"] if others_answered else ["same_unit"] * 3)


@pytest.mark.parametrize(("value", "says"), [(32.0, "Set `response.success"), (212.0, "set none of its fields")])
def test_a_forgotten_success_is_named_also_where_the_right_value_is_zero(value: float, says: str) -> None:
    answer = Answer("", "", response=SimpleNamespace(success=False, value=0.0, message=""))
    node = SimpleNamespace(call=lambda *_, **__: answer)
    with pytest.raises(Failed, match=says):
        Temperatures().expect_conversion(node, Sample(value, FAHRENHEIT, CELSIUS))


def test_where_the_last_digit_is_wrong_it_is_shown() -> None:
    value = 15977377.402510555
    sample, got = Sample(value, FAHRENHEIT, FAHRENHEIT), math.nextafter(value, 0.0)
    answer = Answer("value=15977377.4", "value=15977377.4", response=SimpleNamespace(success=True, value=got))
    job = SimpleNamespace(text=SimpleNamespace(facts=SimpleNamespace(floor_divides=False, rounds=False)))
    node = SimpleNamespace(call=lambda *_, **__: answer, context=SimpleNamespace(job=job, record=ExchangeLog()))
    with pytest.raises(Failed) as failed:
        Temperatures().expect_conversion(node, sample, right=has_every_digit)
    evidence = failed.value.evidence
    assert [repr(number) in text for number, text in ((value, evidence.sent), (got, evidence.got))] == [True, True]
