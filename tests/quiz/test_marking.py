"""What answers earn, and that guessing does not pass."""

from __future__ import annotations

from typing import Any

import pytest

from course_kit import quiz

DRAWN = quiz.draw(1)
FIRST = DRAWN[0]
PATTERN = next(iter(FIRST.accepted))
REASON = FIRST.accepted[PATTERN][0]
BOTH = next(scenario for scenario in quiz.bank().values() if set(scenario.accepted) == {"topic", "service"})


def right(scenario: quiz.Scenario) -> tuple[str, str]:
    pattern = next(iter(scenario.accepted))
    return pattern, scenario.accepted[pattern][0]


def all_right(scenarios: tuple[quiz.Scenario, ...] = DRAWN) -> dict[str, Any]:
    return {scenario.id: right(scenario) for scenario in scenarios}


def test_all_right_is_full_marks() -> None:
    result = quiz.mark(DRAWN, all_right())
    assert (result.points, result.max_points, result.passed, result.strangers) == (10.0, 10.0, True, ())
    assert all(marks.pattern.explanation == marks.scenario.why for marks in result.marks)


def test_each_half_counts_by_itself() -> None:
    wrong_pattern = next(pattern for pattern in quiz.PATTERNS if pattern not in FIRST.accepted)
    wrong_reason = next(reason for reason in FIRST.reasons if reason in FIRST.wrong)
    marks = quiz.mark_one(FIRST, (wrong_pattern, REASON))
    assert (marks.pattern.right, marks.reason.right, marks.points) == (False, True, 0.5)
    assert marks.pattern.explanation == FIRST.wrong[wrong_pattern]
    marks = quiz.mark_one(FIRST, (PATTERN, wrong_reason))
    assert (marks.pattern.right, marks.reason.right, marks.points) == (True, False, 0.5)
    assert marks.reason.explanation == FIRST.wrong[wrong_reason]
    assert marks.reason.code is None


def test_either_answer_of_an_open_scenario_counts_with_its_own_reason_only() -> None:
    for pattern, other in (("topic", "service"), ("service", "topic")):
        assert quiz.mark_one(BOTH, (pattern, BOTH.accepted[pattern][0])).points == 1.0
        crossed = quiz.mark_one(BOTH, (pattern, BOTH.accepted[other][0]))
        assert (crossed.pattern.right, crossed.reason.right) == (True, False)
        assert "the two must fit together" in crossed.reason.explanation


@pytest.mark.parametrize(
    ("answer", "codes", "told"),
    [
        (("", ""), ("quiz.missing", "quiz.missing"), "still empty"),
        ((PATTERN, ""), (None, "quiz.missing"), "still empty"),
        (("publisher", REASON), ("quiz.malformed", None), "'publisher' is not a pattern"),
        (("servise", REASON), ("quiz.malformed", None), "Did you mean 'service'?"),
        ((PATTERN, REASON + "x"), (None, "quiz.malformed"), f"Did you mean '{REASON}'?"),
        ((REASON, PATTERN), ("quiz.malformed", "quiz.malformed"), "are swapped"),
        (PATTERN, ("quiz.malformed", "quiz.malformed"), "one text"),
        ((PATTERN, REASON, "because"), ("quiz.malformed", "quiz.malformed"), "a group of 3"),
        (None, ("quiz.malformed", "quiz.malformed"), "of type NoneType"),
        ((1, 2.5), ("quiz.malformed", "quiz.malformed"), "'1' is not a pattern"),
        (quiz.Unusable("topic", "No quotes."), ("quiz.malformed", "quiz.malformed"), "No quotes."),
        (("x" * 10_000, REASON), ("quiz.malformed", None), "xxx..."),
    ],
)
def test_a_misshapen_answer_is_named_and_the_rest_counts(
    answer: object, codes: tuple[str | None, str | None], told: str
) -> None:
    result = quiz.mark(DRAWN, {**all_right(), FIRST.id: answer})
    marks = result.marks[0]
    assert (marks.pattern.code, marks.reason.code) == codes
    assert any(told in half.explanation for half in (marks.pattern, marks.reason))
    assert result.points == 9.0 + marks.points
    assert marks.points == 0.5 * codes.count(None)


def test_a_missing_answer_is_named() -> None:
    answers = all_right()
    del answers[FIRST.id]
    result = quiz.mark(DRAWN, answers)
    assert (result.marks[0].pattern.code, result.marks[0].reason.code) == ("quiz.missing", "quiz.missing")
    assert result.points == 9.0


def test_an_id_with_a_slip_is_found() -> None:
    answers = all_right()
    answers[FIRST.id + "s"] = answers.pop(FIRST.id)
    result = quiz.mark(DRAWN, answers)
    assert result.strangers == (FIRST.id + "s",)
    assert result.marks[0].pattern.code == "quiz.unknown"
    assert FIRST.id + "s" in result.marks[0].pattern.explanation


def test_answers_to_another_seed_are_recognised() -> None:
    others = {name: right(scenario) for name, scenario in quiz.bank().items() if scenario not in DRAWN}
    result = quiz.mark(DRAWN, others)
    assert result.strangers == ()
    assert {marks.pattern.code for marks in result.marks} == {"quiz.missing"}
    assert "It answers others: if you have your own number, add --seed" in result.marks[0].pattern.explanation
