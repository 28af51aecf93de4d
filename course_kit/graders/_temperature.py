"""Temperatures for exercise 1: what is right, and what well-known mistakes make of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

CELSIUS, FAHRENHEIT = UNITS = ("celsius", "fahrenheit")
ABSOLUTE_ZERO = {CELSIUS: -273.15, FAHRENHEIT: -459.67}
_RELATIVE, _ABSOLUTE = 1e-6, 1e-9  # the right formula, whatever has become of the last digits
_EXACT = 1e-12  # every digit, relative or absolute: each usual formula keeps to it, the route over Kelvin too
_SAME = 1e-9  # how well a mistaken formula has to fit, relative: much better than the tolerance of a right answer
_CALCULATED = 1e-3  # what a way through the other unit and back, or a rounding, costs at most
_DENORMAL = 1e-300  # an integer written into a float field arrives as one of the smallest numbers there are


@dataclass(frozen=True)
class Sample:
    """One conversion to ask for."""

    value: float
    from_unit: str
    to_unit: str

    def shown(self) -> str:
        """As the learner is shown it."""
        return f"value={self.value!r}, from_unit='{self.from_unit}', to_unit='{self.to_unit}'"


def right_value(sample: Sample) -> float:
    """The right result of a valid sample."""
    if sample.from_unit == sample.to_unit:
        return sample.value
    if sample.to_unit == FAHRENHEIT:
        return sample.value * 9.0 / 5.0 + 32.0
    return (sample.value - 32.0) * 5.0 / 9.0


def fits(sample: Sample, value: float) -> bool:
    """Whether `value` comes from the right formula: 1e-6 relative or 1e-9 absolute. Lost digits are `exact`'s part."""
    return math.isclose(value, right_value(sample), rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)


def exact(sample: Sample, value: float) -> bool:
    """Whether `value` has every digit: 1e-12 relative or absolute; the same number where nothing is converted."""
    if sample.from_unit == sample.to_unit:
        return value == sample.value
    right = _exact_value(sample)
    return math.isfinite(value) and abs(Fraction(value) - right) <= Fraction(_EXACT) * max(abs(right), Fraction(1))


def _exact_value(sample: Sample) -> Fraction:
    """The result of a sample that changes its unit, before it is rounded to a float."""
    value = Fraction(sample.value)
    return value * 9 / 5 + 32 if sample.to_unit == FAHRENHEIT else (value - 32) * 5 / 9


@dataclass(frozen=True)
class _Mistake:
    formula: Callable[[float], float]
    code: str
    told: str


_INTEGER, _FORMULA = "math.integer_division", "math.formula"
_CONVERTED = (
    "The values were converted, although from_unit and to_unit are the same. Compare the two units first: if they are "
    "equal, the value stays as it is."
)
_TO_ITSELF = (
    _Mistake(lambda v: v * 9 / 5 + 32, _FORMULA, _CONVERTED),
    _Mistake(lambda v: (v - 32) * 5 / 9, _FORMULA, _CONVERTED),
)
_MISTAKES = {
    **{(unit, unit): _TO_ITSELF for unit in UNITS},
    (CELSIUS, FAHRENHEIT): (
        _Mistake(lambda v: v * (9 // 5) + 32, _INTEGER, "They match a factor of 1, which is what 9 // 5 gives."),
        _Mistake(lambda v: v * 9 / 5, _FORMULA, "They match a formula without the offset of 32."),
        _Mistake(lambda v: (v + 32) * 9 / 5, _FORMULA, "They match a formula that adds 32 before it multiplies."),
        _Mistake(lambda v: v * 9 / 5 - 32, _FORMULA, "They match a formula that subtracts 32 instead of adding it."),
        _Mistake(lambda v: v * 5 / 9 + 32, _FORMULA, "They match a formula with its factor upside down."),
        _Mistake(lambda v: (v - 32) * 5 / 9, _FORMULA, "They are right for the other direction."),
    ),
    (FAHRENHEIT, CELSIUS): (
        _Mistake(
            lambda v: v - 32 * 5 / 9, _FORMULA, "They match v - 32 * 5 / 9: multiplication goes before subtraction."
        ),
        _Mistake(lambda v: v * 5 / 9 - 32, _FORMULA, "They match a formula that subtracts 32 after it multiplies."),
        _Mistake(lambda v: (v + 32) * 5 / 9, _FORMULA, "They match a formula that adds 32 instead of subtracting it."),
        _Mistake(lambda v: (v - 32) * 9 / 5, _FORMULA, "They match a formula with its factor upside down."),
        _Mistake(lambda v: v * 9 / 5 + 32, _FORMULA, "They are right for the other direction."),
    ),
}


def explain(answers: Sequence[tuple[Sample, float]], *, floors: bool) -> tuple[str, str]:
    """What wrong answers have in common.

    Args:
        answers: all samples of one direction with the values that came, at least one of them wrong.
        floors: whether the learner's program uses `//`.

    Returns:
        The diagnosis and a sentence.
    """
    if any(0.0 < abs(got) < _DENORMAL for _, got in answers):
        return "field.type", "A value so close to zero is an integer that was put into a float field."
    for mistake in _MISTAKES.get((answers[0][0].from_unit, answers[0][0].to_unit), ()):
        if all(_same(got, mistake.formula(sample.value)) for sample, got in answers):
            return mistake.code, mistake.told
    if answers[0][0].from_unit == answers[0][0].to_unit:
        changed = max(abs(got - sample.value) for sample, got in answers)
        if changed < _CALCULATED:
            return _FORMULA, f"It is off by {changed:.2g}: a value that needs no conversion was calculated or rounded."
    elif all(_same(got, sample.value) for sample, got in answers):
        return _FORMULA, "They are the values we sent: nothing was converted."
    if all(got == 0.0 for _, got in answers):
        told = "a small number divided by a larger one with // is 0." if floors else "was response.value filled in?"
        return (_INTEGER if floors else _FORMULA), f"Every value came back as 0: {told}"
    return _by_size(answers, floors=floors)


def _by_size(answers: Sequence[tuple[Sample, float]], *, floors: bool) -> tuple[str, str]:
    off = max(abs(got - right_value(sample)) for sample, got in answers)
    if off < 1.0 or (floors and off < 2.0):  # noqa: PLR2004 - // before a factor of 9/5 loses almost two degrees
        return (
            _INTEGER,
            f"They are off by at most {off:.2g} degrees: digits were lost in the calculation (//, int() or round()).",
        )
    return _FORMULA, "They match none of the usual mistakes; check the factor, the offset and the order by hand."


def _same(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=_SAME, abs_tol=_ABSOLUTE)
