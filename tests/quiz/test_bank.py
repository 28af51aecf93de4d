"""The bank of scenarios: large, balanced, complete, and without clues in its form."""

from __future__ import annotations

import re
from collections import Counter

import pytest

from course_kit import quiz
from course_kit.quiz.bank import PRACTICE, QUESTIONS, parse_scenarios

BANK = quiz.bank()
SCENARIOS = list(BANK.values())
every_scenario = pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.id)

TEXT = (
    """
[[scenario]]
id = "one"
title = "t"
field = "f"
text = """
    '''"""
  in two
  lines"""'''
    """
reasons = { a = "A", b = "B", c = "C", d = "D" }
"""
)
ANSWER = """
[answer.one]
source = "s"
why = "w"
accepted = { topic = ["a"] }
wrong = { service = "S", action = "A", b = "B", c = "C", d = "D" }
"""


def deciding(scenario: quiz.Scenario) -> set[str]:
    """The reasons that decide for any accepted pattern."""
    return {reason for reasons in scenario.accepted.values() for reason in reasons}


def test_it_is_large_and_balanced() -> None:
    assert len(quiz.graded()) >= 30
    assert len(quiz.practice()) == 10
    assert not set(quiz.graded()) & set(quiz.practice())
    alone = Counter(tuple(scenario.accepted) for scenario in SCENARIOS)
    assert len(SCENARIOS) >= 36
    assert len({alone[pattern,] for pattern in quiz.PATTERNS}) == 1
    assert sum(len(scenario.accepted) > 1 for scenario in SCENARIOS) >= 3
    assert len({scenario.field for scenario in SCENARIOS}) >= 8


@every_scenario
def test_a_scenario_can_be_asked_and_marked(scenario: quiz.Scenario) -> None:
    identifiers = [scenario.id, *scenario.reasons]
    assert all(re.fullmatch(r"[a-z][a-z0-9_]*", one) and one not in quiz.PATTERNS for one in identifiers)
    assert len(scenario.reasons) == 4
    assert set(scenario.accepted) <= set(quiz.PATTERNS)
    assert all(reasons and set(reasons) <= set(scenario.reasons) for reasons in scenario.accepted.values())
    assert set(scenario.wrong) == {*quiz.PATTERNS, *scenario.reasons} - set(scenario.accepted) - deciding(scenario)
    texts = [scenario.text, scenario.why, *scenario.reasons.values(), *scenario.wrong.values()]
    assert all(texts)
    assert len(set(texts)) == len(texts)
    assert all(len(text.split()) >= 4 for text in scenario.wrong.values())
    for pattern in scenario.accepted:  # of a real interface
        assert {"topic": "/msg/", "service": "/srv/", "action": "/action/"}[pattern] in scenario.source
    if len(scenario.accepted) > 1:
        assert "both" in scenario.why.lower()
        assert not set.intersection(*map(set, scenario.accepted.values()))


@every_scenario
def test_it_is_short_enough_and_a_wrong_guess_does_not_buy_the_right_answer(scenario: quiz.Scenario) -> None:
    assert len(scenario.text.split()) <= 65  # tests/text/test_guides.py holds the length of its sentences
    for choice, text in scenario.wrong.items():
        for pattern in scenario.accepted:
            assert not re.search(rf"\b(an?|the) {pattern}\b", text.lower()), choice


@pytest.mark.parametrize("choose", [max, min])
def test_the_length_of_a_reason_is_no_clue(choose: object) -> None:
    hits = sum(
        choose(scenario.reasons, key=lambda name, texts=scenario.reasons: len(texts[name])) in deciding(scenario)
        for scenario in SCENARIOS
    )
    assert hits <= 0.35 * len(SCENARIOS)


def test_questions_and_answers_may_stand_apart() -> None:
    [made] = parse_scenarios(TEXT, ANSWER).values()
    assert (made.text, made.accepted, made.has_answer) == ("in two lines", {"topic": ("a",)}, True)
    assert parse_scenarios(TEXT + "".join(ANSWER.splitlines(keepends=True)[2:])) == {"one": made}
    alone = parse_scenarios(TEXT)["one"]
    assert (alone.has_answer, alone.accepted, alone.text) == (False, {}, made.text)


def test_what_students_have_tells_nothing_about_what_is_right() -> None:
    """Neither a word of an answer, nor the order in which scenarios and reasons are written down."""
    questions = QUESTIONS.read_text(encoding="utf-8")
    flat = " ".join(questions.split())
    for scenario in quiz.graded().values():
        assert scenario.why not in flat
        assert scenario.source not in flat
        assert not [text for text in scenario.wrong.values() if text in flat]
        assert scenario.id not in PRACTICE.read_text(encoding="utf-8")
    in_file = parse_scenarios(questions)
    assert list(in_file) == sorted(in_file)
    assert all(list(scenario.reasons) == sorted(scenario.reasons) for scenario in in_file.values())
