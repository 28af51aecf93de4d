"""The bank of scenarios, read from `data/` and checked when it is read.

Ten scenarios are for practice (`practice.toml`): everybody has their answers. The others count for a grade; their
questions (`scenarios.toml`) are with everybody, their answers (`answers.toml`) with the instructor alone: a student
edition has no such file. Nothing that a student has tells what is right there, the order of the reasons included.

What decides between the patterns is told by the ROS 2 documentation, "Topics vs Services vs Actions": topics for
continuous streams of data; services for remote calls that end quickly; actions for whatever runs for longer,
gives feedback and can be cancelled.
"""

from __future__ import annotations

import dataclasses
import re
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
    from collections.abc import Mapping

PATTERNS = ("topic", "service", "action")
REASONS = 4  # to choose from in each scenario
FORMAT_VERSION = 1
_DATA = Path(__file__).parent / "data"
QUESTIONS, ANSWERS, PRACTICE = (_DATA / name for name in ("scenarios.toml", "answers.toml", "practice.toml"))
_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]*\Z")


class BankError(ValueError):
    """The file of scenarios cannot be used; the text names the scenario and what is wrong with it."""


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

    @property
    def deciding(self) -> frozenset[str]:
        """The reasons that decide for any accepted pattern."""
        return frozenset(reason for reasons in self.accepted.values() for reason in reasons)


@lru_cache(maxsize=1)
def practice() -> Mapping[str, Scenario]:
    """The scenarios to practise with, by id, in the file's order; each with its answer."""
    return parse(_text_of(PRACTICE))


@lru_cache(maxsize=1)
def graded() -> Mapping[str, Scenario]:
    """The scenarios that count for a grade, by id; each without an answer in a student edition."""
    return parse(_text_of(QUESTIONS), _text_of(ANSWERS) if ANSWERS.exists() else None)


def bank() -> Mapping[str, Scenario]:
    """All scenarios by id."""
    return {**practice(), **graded()}


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as problem:
        raise BankError(f"The scenarios of the quiz cannot be read: {problem.strerror}.") from problem


def parse(text: str, answers: str | None = "") -> Mapping[str, Scenario]:
    """The scenarios in a TOML text."""
    try:
        found = _by_id(_tables(text, "scenario"))
        if answers is None:
            return {name: _question(name, table) for name, table in found.items()}
        right = _right(_tables(answers, "answer") if answers else found, found)
        return {name: _scenario(name, table, right.get(name, {})) for name, table in found.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        what = f"'{problem.args[0]}' is missing" if isinstance(problem, KeyError) else problem
        raise BankError(f"The scenarios of the quiz cannot be used: {what}.") from problem


def _tables(text: str, name: str) -> Any:
    tables = tomllib.loads(text)
    version = tables["format_version"]
    if version != FORMAT_VERSION:
        raise ValueError(f"they have format_version {version}, and this kit reads {FORMAT_VERSION}")
    return tables[name]


def _by_id(tables: Any) -> dict[str, dict[str, Any]]:
    found = {str(table["id"]): table for table in tables}
    if len(found) < len(tables):
        raise ValueError("two have the same id")
    return found


def _right(answers: Any, questions: Mapping[str, Any]) -> Any:
    if strangers := sorted(set(answers) - set(questions)):
        raise ValueError(f"there are answers to {', '.join(strangers)}, and no such questions")
    return answers


def _question(name: str, table: dict[str, Any]) -> Scenario:
    try:
        made = Scenario(
            id=name,
            title=_text(table["title"]),
            field=_text(table["field"]),
            text=_text(table["text"]),
            reasons={reason: _text(text) for reason, text in table["reasons"].items()},
        )
    except KeyError as missing:
        raise ValueError(f"in '{name}', '{missing.args[0]}' is missing") from missing
    if problem := _unlike_a_question(made):
        raise ValueError(f"in '{name}', {problem}")
    return made


def _scenario(name: str, table: dict[str, Any], answer: dict[str, Any]) -> Scenario:
    try:
        made = dataclasses.replace(
            _question(name, table),
            source=_text(answer["source"]),
            why=_text(answer["why"]),
            accepted={pattern: tuple(reasons) for pattern, reasons in answer["accepted"].items()},
            wrong={choice: _text(text) for choice, text in answer["wrong"].items()},
        )
    except KeyError as missing:
        raise ValueError(f"in '{name}', '{missing.args[0]}' is missing") from missing
    if problem := _unlike_an_answer(made):
        raise ValueError(f"in '{name}', {problem}")
    return made


def _text(value: object) -> str:
    """A text in one line; in the file it may be broken anywhere."""
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"{value!r} is not a text")
    return " ".join(value.split())


def _unlike_a_question(scenario: Scenario) -> str:
    """What is wrong with a scenario's question, or nothing."""
    for identifier in (scenario.id, *scenario.reasons):
        if not _IDENTIFIER.match(identifier) or identifier in PATTERNS:
            return f"'{identifier}' cannot be an id"
    if len(scenario.reasons) != REASONS:
        return f"there are {len(scenario.reasons)} reasons instead of {REASONS}"
    return ""


def _unlike_an_answer(scenario: Scenario) -> str:
    """What is wrong with a scenario's answer, or nothing."""
    if not scenario.accepted or not set(scenario.accepted) <= set(PATTERNS):
        return f"the accepted patterns are none of {', '.join(PATTERNS)}"
    if not all(reasons and set(reasons) <= set(scenario.reasons) for reasons in scenario.accepted.values()):
        return "a deciding reason is missing or is none of the four"
    wrong = (set(PATTERNS) - set(scenario.accepted)) | (set(scenario.reasons) - scenario.deciding)
    if set(scenario.wrong) != wrong:
        odd = sorted(set(scenario.wrong) ^ wrong)
        return f"each wrong choice, and no other, needs an explanation; look at {', '.join(odd)}"
    return ""
