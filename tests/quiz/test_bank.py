"""The bank of scenarios: large, balanced, complete, and without clues in its form."""

from __future__ import annotations

import re
from collections import Counter

import pytest

from course_kit import quiz
from course_kit.quiz.bank import PRACTICE, QUESTIONS, parse

BANK = quiz.bank()
SCENARIOS = list(BANK.values())
every_scenario = pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda scenario: scenario.id)

GOOD = """
format_version = 1
[[scenario]]
id = "one"
title = "t"
field = "f"
text = "x"
source = "s"
why = "w"
accepted = { topic = ["a"] }
reasons = { a = "A", b = "B", c = "C", d = "D" }
wrong = { service = "S", action = "A", b = "B", c = "C", d = "D" }
"""


QUESTION = """
format_version = 1
[[scenario]]
id = "one"
title = "t"
field = "f"
text = "x"
reasons = { a = "A", b = "B", c = "C", d = "D" }
"""
ANSWER = """
format_version = 1
[answer.one]
source = "s"
why = "w"
accepted = { topic = ["a"] }
wrong = { service = "S", action = "A", b = "B", c = "C", d = "D" }
"""


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
def test_every_wrong_choice_is_explained_and_nothing_is_said_twice(scenario: quiz.Scenario) -> None:
    assert len(scenario.reasons) == 4
    for choice in {*quiz.PATTERNS, *scenario.reasons} - set(scenario.accepted) - scenario.deciding:
        assert len(scenario.wrong[choice].split()) >= 4
    texts = [scenario.text, scenario.why, *scenario.reasons.values(), *scenario.wrong.values()]
    assert len(set(texts)) == len(texts)


@every_scenario
def test_it_names_a_real_interface(scenario: quiz.Scenario) -> None:
    assert re.search(r"\w+/(msg|srv|action)/[A-Z]\w+|\w+_msgs|audio_common", scenario.source)
    kinds = {"topic": "/msg/", "service": "/srv/", "action": "/action/"}
    for pattern in scenario.accepted:
        assert kinds[pattern] in scenario.source


@every_scenario
def test_it_is_short_enough_for_beginners(scenario: quiz.Scenario) -> None:
    assert len(scenario.text.split()) <= 65
    assert all(len(sentence.split()) <= 36 for sentence in re.split(r"[.?!] ", scenario.text))


@every_scenario
def test_where_several_are_accepted_it_says_why_both_can_be_defended(scenario: quiz.Scenario) -> None:
    if len(scenario.accepted) > 1:
        assert "both" in scenario.why.lower()
        reasons = [set(reasons) for reasons in scenario.accepted.values()]
        assert not set.intersection(*reasons)


@every_scenario
def test_no_explanation_of_a_wrong_choice_names_what_is_right(scenario: quiz.Scenario) -> None:
    """Otherwise one wrong guess would buy the right answer."""
    for choice, text in scenario.wrong.items():
        for pattern in scenario.accepted:
            assert not re.search(rf"\b(an?|the) {pattern}\b", text.lower()), choice


@pytest.mark.parametrize("choose", [max, min])
def test_the_length_of_a_reason_is_no_clue(choose: object) -> None:
    hits = sum(
        choose(scenario.reasons, key=lambda name, texts=scenario.reasons: len(texts[name])) in scenario.deciding
        for scenario in SCENARIOS
    )
    assert hits <= 0.35 * len(SCENARIOS)


def test_a_good_text_is_read() -> None:
    assert parse(GOOD)["one"].accepted == {"topic": ("a",)}


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ('title = "t"\n', "", "in 'one', 'title' is missing"),
        ('id = "one"\n', "", "'id' is missing"),
        ('text = "x"', "text = 3", "3 is not a text"),
        ("format_version = 1", "format_version = 2", "format_version 2"),
        ("topic =", "topics =", "the accepted patterns are none of"),
        ('["a"]', '["e"]', "a deciding reason is missing"),
        ('["a"]', "[]", "a deciding reason is missing"),
        (', d = "D" }\nwrong', " }\nwrong", "3 reasons instead of 4"),
        ('wrong = { service = "S",', "wrong = {", "look at service"),
        ('wrong = { service = "S",', 'wrong = { service = "S", topic = "T",', "look at topic"),
        ('id = "one"', 'id = "One"', "'One' cannot be an id"),
        ("[[scenario]]", "[[scenario", "cannot be used"),
    ],
)
def test_a_mistake_is_named(before: str, after: str, told: str) -> None:
    with pytest.raises(quiz.BankError, match=re.escape(told)):
        parse(GOOD.replace(before, after, 1))


def test_two_scenarios_of_one_name_are_refused() -> None:
    with pytest.raises(quiz.BankError, match="two have the same id"):
        parse(GOOD + GOOD.replace("format_version = 1", ""))


def test_questions_and_answers_may_stand_apart() -> None:
    assert parse(QUESTION, ANSWER) == parse(GOOD)
    alone = parse(QUESTION, None)["one"]
    assert (alone.has_answer, alone.accepted, alone.deciding) == (False, {}, frozenset())


@pytest.mark.parametrize(
    ("answers", "told"),
    [
        (ANSWER.replace("answer.one", "answer.two"), "there are answers to two, and no such questions"),
        (ANSWER.replace('why = "w"\n', ""), "in 'one', 'why' is missing"),
        ("format_version = 1\n[answer]\n", "in 'one', 'source' is missing"),
        (ANSWER.replace("format_version = 1", "format_version = 2"), "format_version 2"),
    ],
)
def test_a_mistake_in_the_answers_is_named(answers: str, told: str) -> None:
    with pytest.raises(quiz.BankError, match=re.escape(told)):
        parse(QUESTION, answers)


def test_what_students_have_tells_nothing_about_what_is_right() -> None:
    """Neither a word of an answer, nor the order in which scenarios and reasons are written down."""
    questions = QUESTIONS.read_text(encoding="utf-8")
    flat = " ".join(questions.split())
    for scenario in quiz.graded().values():
        assert scenario.why not in flat
        assert scenario.source not in flat
        assert not [text for text in scenario.wrong.values() if text in flat]
        assert scenario.id not in PRACTICE.read_text(encoding="utf-8")
    in_file = parse(questions, None)
    assert list(in_file) == sorted(in_file)
    assert all(list(scenario.reasons) == sorted(scenario.reasons) for scenario in in_file.values())
