"""The bank of scenarios, read from `data/scenarios.toml` and checked when it is read.

What decides between the patterns is told by the ROS 2 documentation, "Topics vs Services vs Actions": topics for
continuous streams of data; services for remote calls that end quickly; actions for whatever runs for longer,
gives feedback and can be cancelled.
"""

from __future__ import annotations

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
_FILE = Path(__file__).parent / "data" / "scenarios.toml"
_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]*\Z")
_TEXTS = ("title", "field", "text", "source", "why")


class BankError(ValueError):
    """The file of scenarios cannot be used; the text names the scenario and what is wrong with it."""


@dataclass(frozen=True)
class Scenario:
    """One scenario.

    Attributes:
        id: its name in answers.
        title: a few words for people.
        field: where such robots work.
        text: the situation, with every fact that decides.
        source: the real package and interface it comes from.
        why: why the accepted patterns fit; for several, why each can be defended.
        accepted: each accepted pattern with the ids of the reasons that decide for it.
        reasons: the four reasons to choose from, by id.
        wrong: why not: an explanation for each pattern that is not accepted and each reason that never decides.
    """

    id: str
    title: str
    field: str
    text: str
    source: str
    why: str
    accepted: Mapping[str, tuple[str, ...]]
    reasons: Mapping[str, str]
    wrong: Mapping[str, str]

    @property
    def deciding(self) -> frozenset[str]:
        """The reasons that decide for any accepted pattern."""
        return frozenset(reason for reasons in self.accepted.values() for reason in reasons)


@lru_cache(maxsize=1)
def bank() -> Mapping[str, Scenario]:
    """All scenarios by id, in the file's order.

    Raises:
        BankError: the file cannot be read or has a mistake.
    """
    try:
        text = _FILE.read_text(encoding="utf-8")
    except OSError as problem:
        raise BankError(f"The scenarios of the quiz cannot be read: {problem.strerror}.") from problem
    return parse(text)


def parse(text: str) -> Mapping[str, Scenario]:
    """The scenarios in a TOML text.

    Raises:
        BankError: it has a mistake.
    """
    try:
        tables = tomllib.loads(text)
        version = tables["format_version"]
        scenarios = [_scenario(table) for table in tables["scenario"]]
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        what = f"'{problem.args[0]}' is missing" if isinstance(problem, KeyError) else problem
        raise BankError(f"The scenarios of the quiz cannot be used: {what}.") from problem
    if version != FORMAT_VERSION:
        raise BankError(
            f"The scenarios of the quiz have format_version {version}, and this kit reads {FORMAT_VERSION}."
        )
    found = {scenario.id: scenario for scenario in scenarios}
    if len(found) < len(scenarios):
        raise BankError("The scenarios of the quiz cannot be used: two have the same id.")
    return found


def _scenario(table: dict[str, Any]) -> Scenario:
    name = str(table["id"])
    try:
        texts = {key: _text(table[key]) for key in _TEXTS}
        made = Scenario(
            id=name,
            accepted={pattern: tuple(reasons) for pattern, reasons in table["accepted"].items()},
            reasons={reason: _text(text) for reason, text in table["reasons"].items()},
            wrong={choice: _text(text) for choice, text in table["wrong"].items()},
            **texts,
        )
    except KeyError as missing:
        raise ValueError(f"in '{name}', '{missing.args[0]}' is missing") from missing
    if problem := _problem(made):
        raise ValueError(f"in '{name}', {problem}")
    return made


def _text(value: object) -> str:
    """A text in one line; in the file it may be broken anywhere."""
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"{value!r} is not a text")
    return " ".join(value.split())


def _problem(scenario: Scenario) -> str:
    """What is wrong with a scenario, or nothing."""
    for identifier in (scenario.id, *scenario.reasons):
        if not _IDENTIFIER.match(identifier) or identifier in PATTERNS:
            return f"'{identifier}' cannot be an id"
    if not scenario.accepted or not set(scenario.accepted) <= set(PATTERNS):
        return f"the accepted patterns are none of {', '.join(PATTERNS)}"
    if len(scenario.reasons) != REASONS:
        return f"there are {len(scenario.reasons)} reasons instead of {REASONS}"
    if not all(reasons and set(reasons) <= set(scenario.reasons) for reasons in scenario.accepted.values()):
        return "a deciding reason is missing or is none of the four"
    wrong = (set(PATTERNS) - set(scenario.accepted)) | (set(scenario.reasons) - scenario.deciding)
    if set(scenario.wrong) != wrong:
        odd = sorted(set(scenario.wrong) ^ wrong)
        return f"each wrong choice, and no other, needs an explanation; look at {', '.join(odd)}"
    return ""
