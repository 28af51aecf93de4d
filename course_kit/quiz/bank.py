"""The bank of scenarios, read from `data/`, and which of them a seed draws.

Ten scenarios are for practice (`practice.toml`): everybody has their answers. The others count for a grade; their
questions (`scenarios.toml`) are with everybody, their answers (`answers.toml`) with the instructor alone: a student
edition has no such file. Nothing that a student has tells what is right there, the order of the reasons included.

What decides between the patterns is told by the ROS 2 documentation, "Topics vs Services vs Actions": topics for
continuous streams of data; services for remote calls that end quickly; actions for whatever runs for longer,
gives feedback and can be cancelled.

A seed draws the same ones on every machine and in every Python: by SHA-256, as `random.sample` is not promised to stay
the same. A scenario that is added later leaves the ranks of the others as they are. Nothing is drawn by what is right:
a student edition, which does not know that, has to draw the same ones.
"""

from __future__ import annotations

import dataclasses
import hashlib
import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

PATTERNS = ("topic", "service", "action")
_DATA = Path(__file__).parent / "data"
QUESTIONS, ANSWERS, PRACTICE = (_DATA / name for name in ("scenarios.toml", "answers.toml", "practice.toml"))
DEFAULT_SEED = 1  # as in exercises/pattern_choice/exercise.toml; the scenarios to practise with
DRAWN = 10


@dataclass(frozen=True)
class Scenario:
    """One scenario."""

    id: str
    title: str
    field: str
    text: str
    reasons: Mapping[str, str]
    source: str = ""
    why: str = ""
    accepted: Mapping[str, tuple[str, ...]] = dataclasses.field(default_factory=dict)
    wrong: Mapping[str, str] = dataclasses.field(default_factory=dict)

    @property
    def has_answer(self) -> bool:
        """Whether it can be marked here."""
        return bool(self.accepted)


@lru_cache(maxsize=1)
def practice() -> Mapping[str, Scenario]:
    """The scenarios to practise with, by id, in the file's order; each with its answer."""
    return parse_scenarios(PRACTICE.read_text(encoding="utf-8"))


@lru_cache(maxsize=1)
def graded() -> Mapping[str, Scenario]:
    """The scenarios that count for a grade, by id; each without an answer in a student edition."""
    answers = ANSWERS.read_text(encoding="utf-8") if ANSWERS.exists() else None
    return parse_scenarios(QUESTIONS.read_text(encoding="utf-8"), answers)


def bank() -> Mapping[str, Scenario]:
    """All scenarios by id."""
    return {**practice(), **graded()}


def parse_scenarios(questions: str, answers: str | None = None) -> Mapping[str, Scenario]:
    """The scenarios in a TOML text; those to practise with have their answers beside the questions."""
    right = tomllib.loads(answers)["answer"] if answers else {}
    tables = tomllib.loads(questions)["scenario"]
    return {table["id"]: _scenario({**table, **right.get(table["id"], {})}) for table in tables}


def _scenario(table: Mapping[str, Any]) -> Scenario:
    return Scenario(
        id=table["id"],
        title=table["title"],
        field=table["field"],
        text=_one_line(table["text"]),
        reasons={reason: _one_line(text) for reason, text in table["reasons"].items()},
        source=_one_line(table.get("source", "")),
        why=_one_line(table.get("why", "")),
        accepted={pattern: tuple(reasons) for pattern, reasons in table.get("accepted", {}).items()},
        wrong={choice: _one_line(text) for choice, text in table.get("wrong", {}).items()},
    )


def _one_line(text: str) -> str:
    """In the file it may be broken anywhere."""
    return " ".join(text.split())


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
