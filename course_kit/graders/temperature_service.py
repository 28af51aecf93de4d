"""Exercise 1: the service /convert_temperature, in a conversation with a model.

Lost digits cost the points of one check, `precision`; the others look for the right formula.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.answers import UNFILLED, describe_value
from course_kit.grading.checks.vocabulary import (
    Answer,
    CheckPart,
    Failed,
    GradedNode,
    Model,
    conversation,
    draw_between,
    draw_by,
    draw_one_of,
    endpoints_offered,
    node_name,
    step_rule,
)

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Sequence

    Judge = Callable[["Sample", float], bool]

SERVICE = "/convert_temperature"
CELSIUS, FAHRENHEIT = UNITS = ("celsius", "fahrenheit")
ABSOLUTE_ZERO = {CELSIUS: -273.15, FAHRENHEIT: -459.67}
_WITHIN_S = 1.5  # one answer
_TOGETHER, _AT_A_TIME, _TOGETHER_S = 50, 10, 5.0
_FEWEST = 10  # right answers of the fifty: a wrong formula for one direction is for its own check to say
_EDGE = {CELSIUS: 1e-5, FAHRENHEIT: 0.01}  # degrees; how near to absolute zero we test, and more than rounding costs
_HOT, _COLD = 1e4, {CELSIUS: -100.0, FAHRENHEIT: -148.0}  # who refuses what lies beyond may refuse only that
_RELATIVE, _ABSOLUTE = 1e-6, 1e-9  # the right formula, whatever has become of the last digits
_EXACT = 1e-12  # every digit, relative or absolute: each usual formula keeps to it, the route over Kelvin too
_FEW_DIGITS, _ROUNDED = 3, 0.05  # behind the point, and what is lost at most where one of them is left
_SAME = 1e-9  # how well a mistaken formula has to fit, relative: much better than the tolerance of a right answer
_is_close = partial(math.isclose, rel_tol=_SAME, abs_tol=_ABSOLUTE)
_CALCULATED = 1e-3  # what a way through the other unit and back, or a rounding, costs at most
_CUT_OFF = 2.0  # // before a factor of 9/5 loses almost two degrees
_DENORMAL = 1e-300  # an integer written into a float field arrives as one of the smallest numbers there are
_COMPARED = (0.0, 37.0, -40.0, 123.457, 212.0)  # that are asked for beside a wrong answer, to find its cause
_USUAL = draw_between(-200.0, 500.0)
_ANY = (_USUAL, _USUAL, draw_between(-1.0, 1.0), draw_by(lambda rng: 10 ** rng.uniform(2, 9)))
_COLDER = (0.0, 1.0, 1e5, draw_between(10.0, 1e4))
_LARGE = (1e9, 12345678.9, 1e7 + 0.3, 3.7e12, 1e200)
_KNOWN = (0.0, 32.0, 100.0, 212.0, -40.0, 37.0, 98.6, 0.1, 1e-3, 1e-7, -1e-9, -17.78, *_LARGE)
# The last two: so near to zero, and to another one, that a text with six digits does not show it.
_DIGITS = (1e-3, -272.123456789, 1234567.891, 1e9, 1e7 + 0.3, 12345678.9, 31.999999, 0.1 + 0.2, -17.7777,
           32.0 + 3e-10, 0.3 + 1e-8)  # fmt: skip
_ALMOST_ONE = ((0.0, -0.0), (37.0, math.nextafter(37.0, 0.0)))
_ODD = ("kelvin", "rankine", "", "\u00b0C", "\u83ef\u6c0f", "furlong", "c", "C", "f", "F", "Celsius", "CELSIUS",
        "Fahrenheit", "FAHRENHEIT")  # fmt: skip
_AROUND = ("{} ", " {}", "{}\n", "\u00b0{}", "{}\u00b0", "{}0")  # an exact word with something before or after it
# How a letter may change; the last one is of full width.
_CHANGES = (str.upper, "".format, "{0}{0}".format, "{} ".format, "{}\u0301".format, "{}\u200b".format,
            lambda letter: chr(ord(letter) + 0xFEE0))  # fmt: skip
_NO_NUMBERS = ((math.nan, "NaN"), (math.inf, "infinity"), (-math.inf, "minus infinity"))
_DIRECTION = {FAHRENHEIT: "celsius_to_fahrenheit", CELSIUS: "fahrenheit_to_celsius"}  # the checks
_PAIRS = tuple(product(UNITS, UNITS))
_PLAIN = ("to_fahrenheit", "to_celsius", "convert_every_digit", "convert_same_unit", "ask_again")
_OFTEN = 28  # so that each kind of request comes after each other kind


@dataclass(frozen=True)
class Sample:
    """One conversion to ask for."""

    value: float
    from_unit: str
    to_unit: str


def right_value(sample: Sample) -> float:
    """The right result of a valid sample."""
    return sample.value if sample.from_unit == sample.to_unit else float(_exact_value(sample))


def has_right_formula(sample: Sample, value: float) -> bool:
    """Whether `value` comes from the right formula: 1e-6 relative or 1e-9 absolute, or rounded. Digits may be lost."""
    right = right_value(sample)
    is_rounded = value == round(value, _FEW_DIGITS) and abs(value - right) <= _ROUNDED
    return is_rounded or math.isclose(value, right, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)


def has_every_digit(sample: Sample, value: float) -> bool:
    """Whether `value` has every digit that counts; the same number where nothing is converted."""
    if sample.from_unit == sample.to_unit:
        return value.hex() == sample.value.hex()  # bit for bit: the sign of zero, too
    right = _exact_value(sample)
    return math.isfinite(value) and abs(Fraction(value) - right) <= Fraction(_EXACT) * max(abs(right), Fraction(1))


def _exact_value(sample: Sample) -> Fraction:
    """The result of a sample that changes its unit, before it is rounded to a float."""
    value = Fraction(sample.value)
    return value * 9 / 5 + 32 if sample.to_unit == FAHRENHEIT else (value - 32) * 5 / 9


def _change_word(change: Callable[[str], str], rng: random.Random) -> str:
    """An exact word that is none any more: one of its letters has changed, or each has."""
    word = rng.choice(UNITS)
    places = rng.choice((range(len(word)), [rng.randrange(len(word))]))
    return "".join(change(letter) if place in places else letter for place, letter in enumerate(word))


_NO_UNITS = (*_ODD, *(text.format(unit) for text, unit in zip(_AROUND, 3 * UNITS, strict=True)),
             *(draw_by(partial(_change_word, change)) for change in _CHANGES))  # fmt: skip


def _draw_fifty(rng: random.Random) -> list[Sample]:
    """Valid conversions in both directions, each with another value."""
    return [Sample(rng.uniform(-200.0, 790.0), *UNITS[:: rng.choice((1, -1))]) for _ in range(_TOGETHER)]


class Temperatures(Model):
    """A service that remembers nothing."""

    history = "lives_on"

    def end(self, node: GradedNode) -> None:
        """Two numbers that are almost one are two, and whoever has not been asked for a while answers as quickly."""
        if "answers" in self.lost:
            return
        for unit, pair in product(() if "same_unit" in self.lost else UNITS, _ALMOST_ONE):
            first, second = (Sample(value, unit, unit) for value in pair)
            self.expect_conversion(node, first, right=has_every_digit)
            try:
                self.expect_conversion(node, second, right=has_every_digit)
            except Failed as failed:
                sent = f"{describe_value(vars(first))}; {failed.evidence.sent}"
                failed.evidence = replace(failed.evidence, sent=sent)
                raise
        node.context.wait_until(lambda: False, 1.05)
        self.to_fahrenheit(node, 20.0, UNITS)

    def kind_of(self, rule: str, /, **arguments: Any) -> object:
        """What is asked and of which units: a node may wrongly remember either."""
        units = arguments.get("units") or arguments.get("case", [0, ""])[1]
        return ("", *units) if rule in _PLAIN else (rule, *units[:1])

    @step_rule("celsius_to_fahrenheit", value=draw_one_of(*_KNOWN, *_ANY), units=UNITS)
    def to_fahrenheit(self, node: GradedNode, value: float, units: tuple[str, str]) -> None:
        """Celsius becomes Fahrenheit."""
        self.expect_conversion(node, Sample(value, *units))

    @step_rule("fahrenheit_to_celsius", value=draw_one_of(*_KNOWN, *_ANY), units=UNITS[::-1])
    def to_celsius(self, node: GradedNode, value: float, units: tuple[str, str]) -> None:
        """Fahrenheit becomes Celsius."""
        self.expect_conversion(node, Sample(value, *units))

    @step_rule("precision", case=draw_one_of(*product((*_DIGITS, *_ANY), (UNITS, UNITS[::-1]))))
    def convert_every_digit(self, node: GradedNode, case: tuple[float, tuple[str, str]]) -> None:
        """No digit is lost."""
        self.expect_conversion(node, Sample(case[0], *case[1]), right=has_every_digit)

    @step_rule(
        "same_unit",
        units=draw_one_of(*((unit, unit) for unit in UNITS)),
        often=_OFTEN,
        value=draw_one_of(0.0, -0.0, 0.1, 32.0, -40.0, 1e-9, 123456789.12345678, *_LARGE, *_ANY),
    )
    def convert_same_unit(self, node: GradedNode, units: tuple[str, str], value: float) -> None:
        """A unit converted to itself; each has its own zero, the other one comes at the end."""
        if not value:
            units = _PAIRS[0] if str(value).startswith("-") else _PAIRS[-1]
        self.expect_conversion(node, Sample(value, *units), right=has_every_digit)

    @step_rule(
        "unknown_unit",
        asks=draw_one_of(
            *((20.0, *pair) for word in _NO_UNITS for pair in ((word, CELSIUS), (FAHRENHEIT, word))),
            *((value, word, word) for value in (20.0, 0.0, math.nan, -1e5) for word in ("kelvin", "", "Celsius")),
            *((value, "kelvin", unit) for value in (32.0, math.nan, -1e5) for unit in UNITS),
        ),
        twice=draw_one_of(False, True),
    )
    def refuse_unknown_unit(self, node: GradedNode, asks: tuple[float, str, str], *, twice: bool) -> None:
        """An unknown unit is refused, twice running, too."""
        wrong = [repr(unit) for unit in dict.fromkeys(asks[1:]) if unit not in UNITS]
        what = f"the unknown unit{'s' * (len(wrong) > 1)} {' and '.join(wrong)}"
        first = self.expect_refusal(node, Sample(*asks), what)
        if twice and "answers" not in self.lost:
            self.expect_same_again(node, Sample(*asks), first)

    @step_rule("not_a_number", often=_OFTEN, case=draw_one_of(*product(_NO_NUMBERS, _PAIRS)))
    def refuse_no_number(self, node: GradedNode, case: tuple[tuple[float, str], tuple[str, str]]) -> None:
        """NaN and infinity are refused."""
        (value, what), units = case
        self.expect_refusal(node, Sample(value, *units), what)

    @step_rule("absolute_zero", often=_OFTEN, case=draw_one_of(*product(_COLDER, _PAIRS)))
    def refuse_too_cold(self, node: GradedNode, case: tuple[float, tuple[str, str]]) -> None:
        """A temperature below absolute zero is refused."""
        below, (unit, other) = case
        sample = Sample(ABSOLUTE_ZERO[unit] - max(below, _EDGE[unit]), unit, other)
        zeros = f"{ABSOLUTE_ZERO[CELSIUS]} C = {ABSOLUTE_ZERO[FAHRENHEIT]} F"
        self.expect_refusal(node, sample, f"a temperature below absolute zero ({zeros})")

    @step_rule("absolute_zero", often=_OFTEN, case=draw_one_of(*product((0.0, 0.001, 1.0), _PAIRS)))
    def convert_barely_valid(self, node: GradedNode, case: tuple[float, tuple[str, str]]) -> None:
        """Absolute zero itself is valid, in Celsius."""
        above, (unit, other) = case
        warmer = max(above, _EDGE[unit]) if unit == FAHRENHEIT else above
        self.expect_conversion(node, Sample(ABSOLUTE_ZERO[unit] + warmer, unit, other))

    @step_rule("answers", units=draw_one_of(*_PAIRS))
    def ask_again(self, node: GradedNode, units: tuple[str, str]) -> None:
        """The same request twice running has the same answer."""
        first = self.ask(node, Sample(20.0, *units), "answers")
        self.expect_same_again(node, Sample(20.0, *units), first)

    @step_rule("fifty_calls", often=2, values=draw_by(_draw_fifty))
    def ask_fifty(self, node: GradedNode, values: Sequence[Sample]) -> None:
        """Fifty calls at once, each with its own value."""
        self.ask(node, Sample(20.0, *UNITS), "answers")
        requests = [vars(sample) for sample in values]
        answers = node.call_together(SERVICE, requests, at_a_time=_AT_A_TIME, within_s=_TOGETHER_S)
        wrong = 0
        for sample, answer in zip(values, answers, strict=True):
            if answer.response.success and has_right_formula(sample, answer.response.value):
                continue
            wrong += 1
            if wrong == len(values) - _FEWEST:
                self.expect_conversion(node, sample)
            with node.context.record.looking_away():
                alone = node.call(SERVICE, vars(sample))
            if alone.response == answer.response:
                continue  # that is for the checks of one call to say
            of_another = any(has_right_formula(value, answer.response.value) for value in values)
            reason = "Your node answered another request" if of_another else "Alone, this request gets another answer"
            why = f"{reason}: your callback mixes up values of two calls."
            if alone.response.success and not answer.response.success:
                why = "Alone, this request gets a result; you refused it while others waited for their answer."
            answer.fail(why, expected=f"success=True, value={right_value(sample)!r}", breaks="own_value")

    def expect_conversion(self, node: GradedNode, sample: Sample, right: Judge = has_right_formula) -> None:
        """The answer to a valid request comes in time and is `right`."""
        converts = sample.from_unit != sample.to_unit
        if "precision" in self.lost:  # who has lost that may refuse what is hot
            sample = replace(sample, value=math.fmod(sample.value, _HOT))
        if "absolute_zero" in self.lost and sample.value < _COLD[sample.from_unit]:
            sample = replace(sample, value=-sample.value)
        answer = self.ask(node, sample, "answers")
        response, wanted = answer.response, f"success=True, value={right_value(sample)!r}"
        if not response.success and not response.message.strip():  # no refusal: it has forgotten one line
            value = "The value is right" if has_right_formula(sample, response.value) else "The response has a value"
            why = f"{value}, but `success` is still False, as ROS 2 creates it. Set `response.success = True`."
            if response.value == 0.0 != right_value(sample) and not response.message:
                why = UNFILLED
            answer.fail(why, expected=wanted, breaks="success")
        if not response.success:
            breaks, why = self.blame_refusal(node, sample), "Your service refused a valid request."
            answer.fail(why, expected=wanted, breaks=breaks, diagnosis="validation.overzealous")
        if not right(sample, response.value):
            answers = self.compare_answers(node, sample, response.value)
            facts = node.context.job.text.facts
            diagnosis, reason = explain_answers(answers, floors=facts.floor_divides, rounds=facts.rounds)
            why = f"The grader checked {len(answers)} of your answers. {reason}"
            if right is has_every_digit:  # what is wrong may be the last digit
                got = f"success=True, value={response.value!r}"
                answer = replace(answer, sent=describe_value(vars(sample)), got=got)
            lost = "every_digit" if all(has_right_formula(*pair) for pair in answers) else _DIRECTION[sample.to_unit]
            answer.fail(why, expected=wanted, breaks=lost if converts else "same_unit", diagnosis=diagnosis)

    def expect_same_again(self, node: GradedNode, sample: Sample, first: Answer) -> None:
        """The request that had this answer just before has the same answer again."""
        second = self.ask(node, sample, "lives_on")
        seen = [(response.success, response.value if response.success else not response.message.strip())
                for response in (first.response, second.response)]  # fmt: skip
        if seen[0] != seen[1] and all(value == value for _, value in seen):  # noqa: PLR0124 - NaN is another check's
            both = replace(second, sent=f"{first.sent}; {second.sent}")
            why = "You answered the same request otherwise just before."
            both.fail(why, expected="the same answer twice", breaks="lives_on", diagnosis="service.remembers")

    def blame_refusal(self, node: GradedNode, sample: Sample) -> str:
        """The check or sentence that it costs to refuse a valid sample: that of hot or cold ones if others are not."""
        cold = sample.value < _COLD[sample.from_unit]
        with suppress(Failed), node.context.record.looking_away():
            if (cold or sample.value > _HOT) and node.call(SERVICE, vars(replace(sample, value=20.0))).response.success:
                return "absolute_zero" if cold else "every_digit"
        return "same_unit" if sample.from_unit == sample.to_unit else _DIRECTION[sample.to_unit]

    def ask(self, node: GradedNode, sample: Sample, breaks: str = "") -> Answer:
        """One call is answered in time, unless it is known that it is not."""
        answer = node.call(SERVICE, vars(sample), breaks=breaks)
        if "answers" not in self.lost:
            answer.within(_WITHIN_S, breaks="one_call")
        return answer

    def compare_answers(self, node: GradedNode, sample: Sample, got: float) -> list[tuple[Sample, float]]:
        """A wrong value, and beside it some more of the same units that are asked for to find its cause."""
        answers = [(sample, got)]
        with suppress(Failed), node.context.record.looking_away():
            for value in _COMPARED:
                other = Sample(value, sample.from_unit, sample.to_unit)
                response = node.call(SERVICE, vars(other)).response
                if response.success:
                    answers.append((other, response.value))
        return answers

    def expect_refusal(self, node: GradedNode, sample: Sample, what: str) -> Answer:
        """It is refused with a reason, in time."""
        answer = self.ask(node, sample)
        answer.refused(what=what)
        return answer


CHECKS = [
    endpoints_offered(title="The service /convert_temperature is there, with its type",
                      points=0.5, proves=["service", "only_a_class", "a_program", "start"]),
    node_name("temperature_service", points=0.5, proves=["node"], after=["offered"]),
    *conversation(
        Temperatures,
        CheckPart("answers", "A request gets an answer", points=1.0, proves=["success", "one_call", "lives_on"]),
        CheckPart("celsius_to_fahrenheit", "Celsius becomes Fahrenheit", points=1.0, proves=["both_directions"]),
        CheckPart("fahrenheit_to_celsius", "Fahrenheit becomes Celsius", points=1.0, proves=["both_directions"]),
        CheckPart("same_unit", "If both units are equal, the value does not change", points=0.5, proves=["same_unit"]),
        CheckPart("precision", "No digits are lost, whether the value is large, small or very cold",
                  points=1.0, proves=["every_digit"]),
        CheckPart("unknown_unit", "An unknown unit is refused with a reason",
                  points=1.0, proves=["unknown_unit", "exact_words", "says_why", "checked_first"]),
        CheckPart("not_a_number", "NaN and infinity are refused with a reason",
                  points=1.0, proves=["no_number", "says_why", "checked_first"]),
        CheckPart("absolute_zero",
                  "A temperature below absolute zero is refused with a reason, absolute zero itself is not",
                  points=1.0, proves=["too_cold", "absolute_zero", "says_why", "checked_first"]),
        CheckPart("fifty_calls", "Fifty calls, ten at a time, are all answered within 5 s, each with its own value",
                  points=1.5, proves=["fifty_calls", "own_value"]),
        steps=150, after=["offered"],
    ),
]  # fmt: skip


_CONVERTED = (
    "The values were converted, although from_unit and to_unit are the same. Compare the two units first: if they are "
    "equal, the value stays as it is."
)
_UPSIDE_DOWN = "They match a formula with its factor upside down."
_OTHER_WAY = "They are right for the other direction."
_MISTAKES: dict[tuple[str, str], tuple[tuple[Callable[[float], float], str], ...]] = {
    **{(unit, unit): ((lambda v: v * 9 / 5 + 32, _CONVERTED), (lambda v: (v - 32) * 5 / 9, _CONVERTED))
       for unit in UNITS},
    (CELSIUS, FAHRENHEIT): (
        (lambda v: v + 32, "They match a factor of 1, which is what 9 // 5 gives."),
        (lambda v: v * 9 / 5, "They match a formula without the offset of 32."),
        (lambda v: (v + 32) * 9 / 5, "They match a formula that adds 32 before it multiplies."),
        (lambda v: v * 9 / 5 - 32, "They match a formula that subtracts 32 instead of adding it."),
        (lambda v: v * 5 / 9 + 32, _UPSIDE_DOWN),
        (lambda v: (v - 32) * 5 / 9, _OTHER_WAY),
    ),
    (FAHRENHEIT, CELSIUS): (
        (lambda v: v - 32 * 5 / 9, "They match v - 32 * 5 / 9: multiplication goes before subtraction."),
        (lambda v: v * 5 / 9 - 32, "They match a formula that subtracts 32 after it multiplies."),
        (lambda v: (v + 32) * 5 / 9, "They match a formula that adds 32 instead of subtracting it."),
        (lambda v: (v - 32) * 9 / 5, _UPSIDE_DOWN),
        (lambda v: v * 9 / 5 + 32, _OTHER_WAY),
    ),
}  # fmt: skip


def explain_answers(answers: Sequence[tuple[Sample, float]], *, floors: bool, rounds: bool) -> tuple[str, str]:
    """What wrong answers have in common: the diagnosis and a sentence."""
    integer, formula = "math.integer_division", "math.formula"
    first, off = answers[0][0], max(abs(got - right_value(sample)) for sample, got in answers)
    if any(0.0 < abs(got) < _DENORMAL for _, got in answers):
        return "field.type", "A value so close to zero is an integer that was put into a float field."
    for mistake, hint in _MISTAKES.get((first.from_unit, first.to_unit), ()):
        if all(_is_close(got, mistake(sample.value)) for sample, got in answers):
            return integer if "//" in hint else formula, hint
    if first.from_unit == first.to_unit:
        if off < _CALCULATED:
            lost = f"One answer is off by {off:.2g}: a value that needs no conversion was calculated or rounded."
            return formula, lost if off else "The sign of zero was lost: -0.0 and 0.0 are equal, but not the same bits."
        if off >= _CUT_OFF:
            return formula, "Where from_unit and to_unit are the same, set response.value to the value that was sent."
    elif all(_is_close(got, sample.value) for sample, got in answers):
        return formula, "They are the values we sent: nothing was converted."
    hint = "They match none of the usual mistakes; check the factor, the offset and the order by hand."
    digits_lost = off < (_CUT_OFF if floors else 1.0)
    if all(got == 0.0 for _, got in answers):
        why = "a small number divided by a larger one with // is 0." if floors else "was response.value filled in?"
        hint, digits_lost = f"Every value came back as 0: {why}", floors
    elif digits_lost:
        found = ", ".join((*["//"] * floors, *["int()", "round()"] * rounds))
        why = f" in the calculation ({found})." if found else ". Has each constant of your formula enough of them?"
        hint, digits_lost = f"They are off by at most {off:.2g} degrees: digits were lost{why}", bool(found)
    return (integer if digits_lost else formula), hint
