"""Exercise 1: the service /convert_temperature, called over ROS.

The checks that need no Python stand in the exercise.toml. Here is what knows temperatures: both directions with their
well-known mistakes, the identity bit for bit; unknown units and temperatures below absolute zero refused with a reason,
and the node still running after it. Lost digits cost the points of one check, `precision`, which is declared: the
others look for the right formula.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_interfaces.srv import ConvertTemperature

from course_kit.graders._temperature import (
    ABSOLUTE_ZERO,
    CELSIUS,
    FAHRENHEIT,
    UNITS,
    Sample,
    exact,
    explain,
    fits,
    right_value,
)
from course_kit.grading.checks.check import Check, Evidence, Failed, check
from course_kit.grading.checks.services import Answer, Service, call

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext

INTERFACES = (ConvertTemperature,)
SERVICE = Service("/convert_temperature", ConvertTemperature)
_FIRST = Sample(100.0, CELSIUS, FAHRENHEIT)
_SLOW_S = 1.5  # one answer; the exercise wants fifty in 5 s
_EDGE = 0.01  # degrees; how near to absolute zero we test beside -273.15 C itself
_CHANGES = 0.1  # its last digit suffers on each way through another unit and back, in both units
_RANDOM = 3  # values drawn in a check beside the textbook ones
_SHOWN = 60  # characters of a learner's text that are repeated in the report


@check(points=1.0, depends_on=["offered"], proves=["success", "one_call"])
def answers(context: CheckContext) -> Evidence:
    """A request gets an answer.

    Raises:
        Failed: it gets none.
    """
    sample = _FIRST
    expected = "an answer with success=True"
    answer = _ask(context, sample, expected)
    response, evidence = answer.response, Evidence(sample.shown(), expected, _got(answer.response))
    if not response.success and response.value == 0.0 and not response.message:
        message = (
            "The response came back as ROS 2 creates it: success False, value 0.0, no message. Your "
            "callback filled in nothing."
        )
        raise Failed(evidence, message)
    _require_success(sample, response, expected)
    if answer.latency_s > _SLOW_S:
        message = f"The answer took {answer.latency_s:.1f} s, and meanwhile every other client has to wait."
        raise Failed(evidence, message, "service.blocks")
    return evidence


@check(points=1.0, depends_on=["answers"], proves=["both_directions"])
def celsius_to_fahrenheit(context: CheckContext) -> Evidence:
    """Celsius becomes Fahrenheit."""
    return _converts(context, [0.0, 37.0, -40.0, *_drawn(context)], CELSIUS, FAHRENHEIT)


@check(points=1.0, depends_on=["answers"], proves=["both_directions"])
def fahrenheit_to_celsius(context: CheckContext) -> Evidence:
    """Fahrenheit becomes Celsius."""
    return _converts(context, [212.0, 98.6, -40.0, *_drawn(context)], FAHRENHEIT, CELSIUS)


@check(points=0.5, depends_on=["answers"], proves=["same_unit"])
def same_unit(context: CheckContext) -> Evidence:
    """A unit converted to itself stays what it is."""
    for unit in UNITS:
        evidence = _converts(context, [0.0, _CHANGES, *_drawn(context)], unit, unit, exact)
    return evidence


@check(
    points=1.0, depends_on=["answers"], proves=["unknown_unit", "exact_words", "says_why", "lives_on", "checked_first"]
)
def unknown_unit(context: CheckContext) -> Evidence:
    """An unknown unit is refused with a reason."""
    odd = context.random.choice(("furlong", "parsec", "bushel", "fathom"))
    pairs = [("kelvin", CELSIUS), (CELSIUS, "kelvin"), (odd, odd), ("", FAHRENHEIT), (CELSIUS, "")]
    for unit in UNITS:  # the words are exact: no other case, no abbreviation, no blanks
        near = [unit.capitalize(), unit.upper(), unit[0], unit[0].upper(), f" {unit}", f"{unit} "]
        pairs += [(word, to) for word, to in zip(near, UNITS * len(near), strict=False)]
        pairs.append((unit, context.random.choice(near)))
    return _refuses(context, [Sample(20.0, *pair) for pair in pairs], _units_of)


@check(
    points=1.0, depends_on=["answers"], proves=["too_cold", "absolute_zero", "says_why", "lives_on", "checked_first"]
)
def absolute_zero(context: CheckContext) -> Evidence:
    """A temperature below absolute zero is refused with a reason, absolute zero itself is not."""
    below = (_EDGE, context.random.uniform(300.0, 1000.0))
    samples = [Sample(ABSOLUTE_ZERO[unit] - by, unit, to) for unit in UNITS for to in UNITS for by in below]
    zeros = f"{ABSOLUTE_ZERO[CELSIUS]} C = {ABSOLUTE_ZERO[FAHRENHEIT]} F"
    evidence = _refuses(context, samples, lambda _: f"a temperature below absolute zero ({zeros})")
    valid = [Sample(ABSOLUTE_ZERO[CELSIUS] + warmer, CELSIUS, FAHRENHEIT) for warmer in (0.0, _EDGE)]
    valid.append(Sample(ABSOLUTE_ZERO[FAHRENHEIT] + _EDGE, FAHRENHEIT, CELSIUS))
    for sample in valid:
        expected = "success=True: this is not below absolute zero"
        _require_success(sample, _ask(context, sample, expected).response, expected)
    return evidence


CHECKS: tuple[Check, ...] = (
    answers,
    celsius_to_fahrenheit,
    fahrenheit_to_celsius,
    same_unit,
    unknown_unit,
    absolute_zero,
)


def _drawn(context: CheckContext) -> list[float]:
    """Values at random; always one on each side of 0, so that the same mistake costs the same with any seed."""
    ranges = [(-200.0, -1.0), (1.0, 500.0), *[(-200.0, 500.0)] * (_RANDOM - 2)]
    return [round(context.random.uniform(*span), 3) for span in ranges]


def _request(sample: Sample) -> ConvertTemperature.Request:
    return ConvertTemperature.Request(value=sample.value, from_unit=sample.from_unit, to_unit=sample.to_unit)


def _ask(context: CheckContext, sample: Sample, expected: str) -> Answer:
    return call(context, SERVICE, _request(sample), sample.shown(), expected)


def _converts(
    context: CheckContext,
    values: Sequence[float],
    from_unit: str,
    to_unit: str,
    right: Callable[[Sample, float], bool] = fits,
) -> Evidence:
    """All values converted, as far as `right` looks; evidence of the first wrong one, else of the last."""
    answers, first_wrong = [], None
    for value in values:
        sample = Sample(value, from_unit, to_unit)
        response = _ask(context, sample, _wanted(sample)).response
        _require_success(sample, response, _wanted(sample))
        answers.append((sample, response.value))
        if first_wrong is None and not right(sample, response.value):
            first_wrong = (len(answers) - 1, response)
        last = Evidence(sample.shown(), _wanted(sample), _got(response))
    if first_wrong is not None:
        place, response = first_wrong
        raise _wrong(context, [answers[place], *answers], response)
    return last


def _units_of(sample: Sample) -> str:
    """The unknown units of a sample, in words: `the unknown unit 'kelvin'`."""
    unknown = [repr(unit) for unit in dict.fromkeys((sample.from_unit, sample.to_unit)) if unit not in UNITS]
    return f"the unknown unit{'s' * (len(unknown) > 1)} {' and '.join(unknown)}"


def _refuses(context: CheckContext, samples: Sequence[Sample], what: Callable[[Sample], str]) -> Evidence:
    """All samples refused with a reason, and the node alive after it; `what` names what is wrong with one."""
    expected = "success=False and a message that says why"
    for sample in samples:
        response = _ask(context, sample, expected).response
        evidence = Evidence(sample.shown(), expected, _got(response))
        if response.success:
            message = f"Your service accepted {what(sample)}."
            raise Failed(evidence, message, "validation.missing")
        if not response.message.strip():
            message = (
                f"Your service was right to refuse {what(sample)}, but its message is empty: the client "
                "cannot tell why."
            )
            raise Failed(evidence, message, "validation.no_reason")
    after = Sample(0.0, CELSIUS, FAHRENHEIT)
    _require_success(
        after, _ask(context, after, "an answer: the node is still running").response, "an answer with success=True"
    )
    return evidence


def _require_success(sample: Sample, response: ConvertTemperature.Response, expected: str) -> None:
    if not response.success:
        evidence = Evidence(sample.shown(), expected, _got(response))
        if response.value != 0.0 and not response.message.strip():  # no refusal: it has forgotten one line
            value = "The value is right" if fits(sample, response.value) else "The response has a value"
            message = f"{value}, but `success` is still False, as ROS 2 creates it. Set `response.success = True`."
            raise Failed(evidence, message)
        raise Failed(evidence, "Your service refused a valid request.", "validation.overzealous")


def _wrong(
    context: CheckContext, answers: Sequence[tuple[Sample, float]], response: ConvertTemperature.Response
) -> Failed:
    """A wrong value, the first of `answers`, explained by all of them."""
    sample = answers[0][0]
    diagnosis, reason = explain(answers, floors=context.job.facts.floor_divides)
    message = f"This compares the answers to {len(answers)} requests. {reason}" if len(answers) > 1 else reason
    return Failed(Evidence(sample.shown(), _wanted(sample), _got(response)), message, diagnosis)


def _wanted(sample: Sample) -> str:
    return f"success=True, value={right_value(sample)!r}"


def _got(response: ConvertTemperature.Response) -> str:
    message = response.message if len(response.message) <= _SHOWN else response.message[:_SHOWN] + "..."
    return f"success={response.success}, value={response.value!r}, message={message!r}"
