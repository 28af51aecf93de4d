"""Exercise 1: the service /convert_temperature, called over ROS.

What is wanted: both directions to 1e-12 relative or absolute, the identity bit for bit; unknown units, NaN, infinity
and temperatures below absolute zero refused with a reason, and the node still running after it; fifty calls within 5 s.
Lost digits cost the points of one check, `precision`: the others look for the right formula.
"""

from __future__ import annotations

import math
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
from course_kit.grading.checks.discovery import ensure_ready, expect_node, expect_offered
from course_kit.grading.checks.load_test import Load, call_many
from course_kit.grading.checks.services import Answer, Service, call

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext

INTERFACES = (ConvertTemperature,)
NODE = "/temperature_service"
SERVICE = Service("/convert_temperature", ConvertTemperature)
_FIRST = Sample(100.0, CELSIUS, FAHRENHEIT)
_SLOW_S = 1.5  # one answer; the exercise wants fifty in 5 s
_EDGE = 0.01  # degrees; how near to absolute zero we test beside -273.15 C itself
_CHANGES = 0.1  # its last digit suffers on each way through another unit and back, in both units
_LARGE = 1e9  # the largest magnitude that is tested
_LOAD = Load(clients=10, unanswered=10, seconds=5.0)
_CALLS = 50
_RANDOM = 3  # values drawn in a check beside the textbook ones
_NUMBERS = {"nan": "NaN", "inf": "infinity", "-inf": "minus infinity"}
_SHOWN = 60  # characters of a learner's text that are repeated in the report


@check(points=0.5, deadline_s=12.0, proves=["service", "only_a_class", "a_program", "start"])
def offered(context: CheckContext) -> Evidence:
    """The service /convert_temperature is there, with its type."""
    return expect_offered(context, SERVICE, _request(_FIRST))


@check(points=0.5, depends_on=["offered"], proves=["node"])
def node_name(context: CheckContext) -> Evidence:
    """The node is called temperature_service."""
    return expect_node(context, NODE, lambda: ensure_ready(context, SERVICE))


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


@check(points=1.0, depends_on=["celsius_to_fahrenheit", "fahrenheit_to_celsius"], proves=["every_digit"])
def precision(context: CheckContext) -> Evidence:
    """No digits are lost, whether the value is large, small or very cold."""
    values = [1e-3, context.random.uniform(-1.0, 1.0), -272.123456789, 1234567.891, _LARGE]
    _converts(context, values, FAHRENHEIT, CELSIUS, exact)
    return _converts(context, values, CELSIUS, FAHRENHEIT, exact)


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


@check(points=1.0, depends_on=["answers"], proves=["no_number", "says_why", "lives_on", "checked_first"])
def not_a_number(context: CheckContext) -> Evidence:
    """NaN and infinity are refused with a reason."""
    samples = [Sample(value, CELSIUS, FAHRENHEIT) for value in (math.nan, math.inf, -math.inf)]
    samples += [Sample(math.nan, FAHRENHEIT, CELSIUS), Sample(math.inf, CELSIUS, CELSIUS)]
    return _refuses(context, samples, lambda sample: _NUMBERS[str(sample.value)])


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


@check(points=1.5, depends_on=["answers"], deadline_s=30.0, proves=["fifty_calls", "own_value"])
def fifty_calls(context: CheckContext) -> Evidence:
    """Fifty calls, ten at a time, each get the answer to their own value within 5 s.

    Raises:
        Failed: one gets another, or none.
    """
    directions = ((CELSIUS, FAHRENHEIT), (FAHRENHEIT, CELSIUS))
    samples = [Sample(context.random.uniform(-200.0, 1000.0), *directions[number % 2]) for number in range(_CALLS)]
    sent = f"{_CALLS} requests from {_LOAD.clients} clients, at most {_LOAD.unanswered} unanswered at a time"
    expected = f"{_CALLS} answers within {_LOAD.seconds:g} s, each to its own request"
    responses = call_many(context, SERVICE, [_request(sample) for sample in samples], _LOAD, Evidence(sent, expected))
    for sample, response in zip(samples, responses, strict=True):
        if response.success and fits(sample, response.value):
            continue
        if any(fits(other, response.value) for other in samples):
            message = "This is the answer to another client's request: your callback mixes up values of two calls."
            raise Failed(Evidence(sample.shown(), _wanted(sample), _got(response)), message)
        _require_success(sample, response, _wanted(sample))
        raise _wrong(context, [(sample, response.value)], response)
    return Evidence(sent, expected, expected)


CHECKS: tuple[Check, ...] = (
    offered,
    node_name,
    answers,
    celsius_to_fahrenheit,
    fahrenheit_to_celsius,
    same_unit,
    precision,
    unknown_unit,
    not_a_number,
    absolute_zero,
    fifty_calls,
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
