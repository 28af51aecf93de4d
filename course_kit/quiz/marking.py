"""What answers earn: half a point for the pattern, half for the reason.

An answer is a pair: the pattern, then the id of a reason. Whatever else stands there (nothing, a word, a number) is
named and earns nothing, and the other answers count.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.quiz.bank import PATTERNS, bank
from course_kit.ros import names as ros_names

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from course_kit.quiz.bank import Scenario

PASS_SHARE = 0.8  # of all points
HALF = 0.5
MISSING, UNKNOWN, MALFORMED = "quiz.missing", "quiz.unknown", "quiz.malformed"
_NOT_HERE = "Only your instructor can mark this: the answers are not in this edition of the course."
_NEAR = 0.75  # how alike two ids are that one may have been meant for the other; 1.0 is the same
_NO_LITERAL = (ValueError, TypeError, SyntaxError, RecursionError, MemoryError)
_LONGEST = 500  # characters of an answer or its id, as text
_SHOWN = 60  # characters of an answer that are repeated
_MOST = 200  # ids that are compared: it takes the square of their length


@dataclass(frozen=True)
class NoAnswer:
    """Stands for an answer that is no value at all; `text` is what was written, `problem` a sentence about it."""

    text: str
    problem: str


def read_answers(entries: Iterable[Sequence[str]]) -> dict[object, object]:
    """The answers in a program's text (`reader.literals`), or those that it has set (`sandbox.runner`)."""
    answers: dict[object, object] = {}
    for key, text, *problem in entries:
        try:
            value = NoAnswer(text, problem[0]) if any(problem) else _read_literal(text)
        except _NO_LITERAL:
            value = NoAnswer(text, "An answer has to be plain texts, but this is something else.")
        try:
            answers[_read_literal(key)] = value
        except _NO_LITERAL:
            answers[key] = value
    return answers


def _read_literal(text: str) -> object:
    if len(text) > _LONGEST:
        raise ValueError("the answer is too long to be read")
    return ast.literal_eval(text)


@dataclass(frozen=True)
class HalfMarks:
    """One half of an answer."""

    right: bool
    got: str
    explanation: str
    code: str | None = None


@dataclass(frozen=True)
class Marks:
    """One scenario, marked."""

    scenario: Scenario
    pattern: HalfMarks
    reason: HalfMarks

    @property
    def points(self) -> float:
        """0.0, 0.5 or 1.0."""
        return HALF * (self.pattern.right + self.reason.right)


@dataclass(frozen=True)
class MarkedAnswers:
    """All scenarios, marked; `strangers` are the entries whose id is in no bank."""

    marks: tuple[Marks, ...]
    strangers: tuple[str, ...] = ()

    @property
    def points(self) -> float:
        """The sum."""
        return sum(marks.points for marks in self.marks)

    @property
    def max_points(self) -> float:
        """One point a scenario."""
        return 2 * HALF * len(self.marks)

    def describe_state(self) -> str:
        """How many answers are complete, and what the others lack."""
        left = [
            f"{marks.scenario.id} ({half.explanation.rstrip('.')})"
            for marks in self.marks
            for half in [half for half in (marks.pattern, marks.reason) if half.code][:1]
        ]
        text = f"{len(self.marks) - len(left)} of {len(self.marks)} answers are complete."
        return f"{text} Still to do: {'; '.join(left)}." if left else text

    @property
    def is_final(self) -> bool:
        """Whether all could be marked here: the answers are known."""
        return all(marks.scenario.has_answer for marks in self.marks)

    @property
    def passed(self) -> bool:
        """Whether the points reach the pass mark."""
        return self.points >= PASS_SHARE * self.max_points


def mark(scenarios: Sequence[Scenario], answers: Mapping[Any, object]) -> MarkedAnswers:
    """Mark the answers to `scenarios`."""
    known = bank()
    given = {_plain(name): answer for name, answer in answers.items()}
    drawn = [scenario.id for scenario in scenarios]
    strangers = [name for name in given if name not in known and name not in drawn]
    others = sum(name in known and name not in drawn for name in given)
    marks = (
        mark_one(scenario, given[scenario.id]) if scenario.id in given else _zero(scenario, strangers, others)
        for scenario in scenarios
    )
    return MarkedAnswers(tuple(marks), tuple(strangers))


def mark_one(scenario: Scenario, answer: object) -> Marks:
    """Mark the answer to one scenario."""
    if isinstance(answer, NoAnswer):
        return _mark_misshapen(scenario, answer.text, answer.problem)
    if not isinstance(answer, (tuple, list)) or len(answer) != 2:  # noqa: PLR2004 - a pair
        problem = f'An answer is a pair such as ("topic", "reason_id"), but this is {_kind(answer)}.'
        return _mark_misshapen(scenario, repr(answer), problem)
    pattern, reason = (_plain(part) for part in answer)
    if pattern in scenario.reasons and reason in PATTERNS:
        problem = "Pattern and reason are swapped: the pattern comes first."
        return _mark_misshapen(scenario, repr(answer), problem)
    return Marks(scenario, _pattern(scenario, pattern), _reason(scenario, pattern, reason))


def nearest_id(name: str, names: Collection[str]) -> str | None:
    """The one of `names` that `name` was probably meant to be."""
    return ros_names.nearest_name(name, sorted(names)[:_MOST], _NEAR)


def _pattern(scenario: Scenario, given: str) -> HalfMarks:
    if not given:
        return HalfMarks(False, "", "The pattern is still empty.", MISSING)
    if given not in PATTERNS:
        return HalfMarks(False, _cut(given), _no_choice(given, "pattern", PATTERNS), MALFORMED)
    if not scenario.has_answer:
        return HalfMarks(False, given, _NOT_HERE)
    if given in scenario.accepted:
        return HalfMarks(True, given, scenario.why)
    return HalfMarks(False, given, scenario.wrong[given])


def _reason(scenario: Scenario, pattern: str, given: str) -> HalfMarks:
    if not given:
        return HalfMarks(False, "", "The reason is still empty.", MISSING)
    if given not in scenario.reasons:
        return HalfMarks(False, _cut(given), _no_choice(given, "reason", tuple(scenario.reasons)), MALFORMED)
    if not scenario.has_answer:
        return HalfMarks(False, given, _NOT_HERE)
    if given in scenario.wrong:
        return HalfMarks(False, given, scenario.wrong[given])
    if pattern in scenario.accepted and given not in scenario.accepted[pattern]:
        problem = f"This is a reason for another pattern, not for the one you chose ({pattern})"
        return HalfMarks(False, given, f"{problem}: the two must fit together.")
    return HalfMarks(True, given, scenario.why)


def _zero(scenario: Scenario, strangers: Collection[str], others: int) -> Marks:
    code, problem = MISSING, "Your file has no answer to this scenario."
    if meant := nearest_id(scenario.id, strangers):
        code = UNKNOWN
        problem = f"Your file has no answer for this id, but one for '{_cut(meant)}', which is not a scenario."
    elif others:
        problem += " It answers others: if you have your own number, add --seed and the number."
    half = HalfMarks(False, "", problem, code)
    return Marks(scenario, half, half)


def _mark_misshapen(scenario: Scenario, answer: str, problem: str) -> Marks:
    half = HalfMarks(False, _cut(answer), problem, MALFORMED)
    return Marks(scenario, half, half)


def _no_choice(given: str, kind: str, choices: Sequence[str]) -> str:
    meant = nearest_id(given, choices)
    proposal = f" Did you mean '{meant}'?" if meant else ""
    return f"'{_cut(given)}' is not a {kind} of this scenario; it has to be one of {', '.join(choices)}.{proposal}"


def _plain(value: object) -> str:
    """An id as it is compared: case and spaces around it do not matter; what is no text is no id."""
    return value.strip().casefold() if isinstance(value, str) else repr(value)


def _kind(answer: object) -> str:
    if isinstance(answer, str):
        return "one text"
    if isinstance(answer, (tuple, list)):
        return f"a group of {len(answer)}"
    return f"of type {type(answer).__name__}"


def _cut(text: str) -> str:
    return text if len(text) <= _SHOWN else text[:_SHOWN] + "..."
