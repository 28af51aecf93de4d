"""Which scenarios a seed draws, the same ones on every machine and in every Python.

`random.Random(seed).sample` is not promised to stay the same between Python versions (only `random()` is), and a class
may well run on several. So the drawing rests on SHA-256: each scenario gets a rank from the seed and its own id.
A scenario that is added to the bank later leaves the ranks of the others as they are. Nothing is drawn by what is
right: a student edition, which does not know that, has to draw the same ones.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from course_kit.quiz.bank import graded, practice

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from course_kit.quiz.bank import Scenario

DEFAULT_SEED = 1  # as in exercises/pattern_choice/exercise.toml; the scenarios to practise with
DRAWN = 10


def draw(seed: int = DEFAULT_SEED, scenarios: Mapping[str, Scenario] | None = None) -> tuple[Scenario, ...]:
    """The ten scenarios of a seed, in the order to show them."""
    if scenarios is None:
        scenarios = practice() if seed == DEFAULT_SEED else graded()
    chosen = _ranked(f"{seed}/draw", scenarios)[:DRAWN]
    return tuple(scenarios[name] for name in _ranked(f"{seed}/order", chosen))


def reasons_as_shown(scenario: Scenario, seed: int = DEFAULT_SEED) -> tuple[tuple[str, str], ...]:
    """The reasons of a scenario, id and text, shuffled: their places tell nothing."""
    return tuple((name, scenario.reasons[name]) for name in _ranked(f"{seed}/{scenario.id}", scenario.reasons))


def _ranked(salt: str, names: Iterable[str]) -> list[str]:
    return sorted(names, key=lambda name: hashlib.sha256(f"{salt}/{name}".encode()).digest())
