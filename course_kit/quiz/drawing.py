"""Which scenarios a seed draws, the same ones on every machine and in every Python.

`random.Random(seed).sample` is not promised to stay the same between Python versions (only `random()` is), and a class
may well run on several. So the drawing rests on SHA-256: each scenario gets a rank from the seed and its own id.
A scenario that is added to the bank later leaves the ranks of the others as they are.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

from course_kit.quiz.bank import PATTERNS, bank

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from course_kit.quiz.bank import Scenario

DEFAULT_SEED = 1  # as in exercises/pattern_choice/exercise.toml
DRAWN = 10
_OF_EACH = 2  # at least so many that accept each pattern alone


def draw(seed: int = DEFAULT_SEED, scenarios: Mapping[str, Scenario] | None = None) -> tuple[Scenario, ...]:
    """The ten scenarios of a seed, in the order to show them.

    At least two of them accept each pattern alone; the others come as they come, so that counting does not
    give the last ones away.

    Args:
        seed: any integer.
        scenarios: the bank to draw from, the course's own when None.

    Raises:
        BankError: the course's bank cannot be used.
    """
    scenarios = bank() if scenarios is None else scenarios
    ranked = _ranked(f"{seed}/draw", scenarios)
    chosen = [name for pattern in PATTERNS for name in _only(pattern, ranked, scenarios)[:_OF_EACH]]
    chosen += [name for name in ranked if name not in chosen][: DRAWN - len(chosen)]
    return tuple(scenarios[name] for name in _ranked(f"{seed}/order", chosen))


def reasons_as_shown(scenario: Scenario, seed: int = DEFAULT_SEED) -> tuple[tuple[str, str], ...]:
    """The reasons of a scenario, id and text, shuffled: their places tell nothing."""
    return tuple((name, scenario.reasons[name]) for name in _ranked(f"{seed}/{scenario.id}", scenario.reasons))


def _only(pattern: str, names: Iterable[str], scenarios: Mapping[str, Scenario]) -> list[str]:
    return [name for name in names if tuple(scenarios[name].accepted) == (pattern,)]


def _ranked(salt: str, names: Iterable[str]) -> list[str]:
    return sorted(names, key=lambda name: hashlib.sha256(f"{salt}/{name}".encode()).digest())
