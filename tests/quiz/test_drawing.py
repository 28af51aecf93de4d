"""Which scenarios a seed draws."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import pytest

from course_kit import quiz
from course_kit.quiz.bank import QUESTIONS, Scenario, parse_scenarios

if TYPE_CHECKING:
    from collections.abc import Mapping

SEEDS = range(2, 202)
GOLDEN_1 = [20, 4, 22, 7, 8, 25, 6, 10, 2, 28]
GOLDEN_2 = [28, 24, 9, 25, 13, 1, 16, 17, 0, 29]
GOLDEN_REASONS = ["d", "a", "c", "b"]


def some(number: int) -> dict[str, Scenario]:
    """A bank that has nothing to do with the course's: its draw must never change."""
    made = {}
    for place in range(number):
        name = f"scenario_{place}"
        accepted = {quiz.PATTERNS[place % 3]: ("a",)}
        made[name] = Scenario(name, "", "", "", dict.fromkeys("abcd", ""), accepted=accepted)
    return made


def unanswered() -> Mapping[str, Scenario]:
    return parse_scenarios(QUESTIONS.read_text(encoding="utf-8"))


def names(scenarios: tuple[Scenario, ...]) -> list[int]:
    return [int(scenario.id.rpartition("_")[2]) for scenario in scenarios]


def test_the_draw_is_the_same_everywhere() -> None:
    """Golden values: a learner's scenarios may not depend on the Python or the machine."""
    assert names(quiz.draw(1, some(36))) == GOLDEN_1
    assert names(quiz.draw(-20260101, some(36))) == GOLDEN_2
    assert [name for name, _ in quiz.reasons_as_shown(some(1)["scenario_0"], 5)] == GOLDEN_REASONS


@pytest.mark.parametrize("seed", [0, 1, 17, -3, 2**40])
def test_ten_different_ones_and_nothing_for_practice_among_those_that_count(seed: int) -> None:
    drawn = quiz.draw(seed)
    assert len({scenario.id for scenario in drawn}) == 10
    assert quiz.draw(seed) == drawn
    assert {scenario.id for scenario in drawn} <= set(quiz.practice() if seed == quiz.DEFAULT_SEED else quiz.graded())


def test_what_is_right_does_not_decide_what_is_drawn() -> None:
    """A student edition has no answers, and has to draw what the instructor's draws."""
    for seed in (2, 17, 90210):
        assert quiz.draw(seed, unanswered()) == tuple(unanswered()[scenario.id] for scenario in quiz.draw(seed))


def test_seeds_draw_different_ones_and_every_scenario_is_drawn() -> None:
    drawn = [tuple(scenario.id for scenario in quiz.draw(seed)) for seed in SEEDS]
    assert len(set(drawn)) == len(SEEDS)
    counts = Counter(name for names_of_one in drawn for name in names_of_one)
    assert set(counts) == set(quiz.graded())
    assert max(counts.values()) < 3 * min(counts.values())


def test_the_place_of_a_reason_is_no_clue() -> None:
    places = Counter(
        place
        for seed in SEEDS
        for scenario in quiz.draw(seed)
        for place, (name, _) in enumerate(quiz.reasons_as_shown(scenario, seed))
        if name in {one for reasons in scenario.accepted.values() for one in reasons}
    )
    assert max(places.values()) < 1.2 * min(places.values())
