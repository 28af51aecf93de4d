"""The bank of scenarios, read from `data/`, which of them a seed draws, and how a learner sees them.

Ten scenarios are for practice (`practice.toml`): everybody has their answers. The others count for a grade; their
questions (`scenarios.toml`) are with everybody, their answers (`answers.toml`) with the instructor alone.

A seed draws the same ones on every machine and in every Python: by SHA-256, as `random.sample` is not promised to stay
the same. Nothing is drawn by what is right: a student edition, which does not know that, has to draw the same ones.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping  # noqa: TC003 - msgspec looks it up
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from course_kit.text.console import wrap_text
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Iterable

PATTERNS = ("topic", "service", "action")
_DATA = Path(__file__).parent / "data"
QUESTIONS, ANSWERS, PRACTICE = (_DATA / name for name in ("scenarios.toml", "answers.toml", "practice.toml"))
DEFAULT_SEED = 1  # as in exercises/pattern_choice/exercise.toml; the scenarios to practise with
DRAWN = 10
_TEMPLATE = Path(__file__).with_name("templates") / "scenarios.html"
_ASKED = "Which pattern fits best (topic, service or action), and which one of the four reasons decides?"
# The list is that of the exercise's exercise.toml, sentence by sentence; a test compares.
_HEAD = '''"""Exercise 4: which communication pattern fits?

- For each of your ten scenarios you get half a point for the pattern that fits:
  `topic`, `service` or `action`. You get another half point for the reason that
  decides: one of the four below the scenario.
- Several reasons may be true, but only one decides: if that one were not true,
  you would choose another pattern.
- In a few scenarios two patterns can be defended. Then each of the two counts,
  with the reason that belongs to it.
- The answers are a dictionary called `answers`. Each scenario has an entry: the
  id of the scenario, then the pattern and the id of the reason, as in
  `"some_robot": ("topic", "some_reason"),`. Capital letters in these words, and
  spaces around them, do not matter. Keep it a plain dictionary of texts: then
  the grader only reads your file. If your file computes the answers, the grader
  runs it.
- An answer that is missing or malformed earns nothing, and the others count. An
  entry that belongs to no scenario is reported; it costs nothing by itself.
"""
'''


class Scenario(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One scenario."""

    id: str
    title: str
    field: str
    text: str
    reasons: Mapping[str, str]
    source: str = ""
    why: str = ""
    accepted: Mapping[str, tuple[str, ...]] = {}
    wrong: Mapping[str, str] = {}

    @property
    def has_answer(self) -> bool:
        """Whether it can be marked here."""
        return bool(self.accepted)


@lru_cache(maxsize=1)
def practice_scenarios() -> Mapping[str, Scenario]:
    """The scenarios to practise with, by id, in the file's order; each with its answer."""
    return parse_scenarios(PRACTICE.read_text(encoding="utf-8"))


@lru_cache(maxsize=1)
def graded_scenarios() -> Mapping[str, Scenario]:
    """The scenarios that count for a grade, by id; each without an answer in a student edition."""
    answers = ANSWERS.read_text(encoding="utf-8") if ANSWERS.exists() else None
    return parse_scenarios(QUESTIONS.read_text(encoding="utf-8"), answers)


def bank() -> Mapping[str, Scenario]:
    """All scenarios by id."""
    return {**practice_scenarios(), **graded_scenarios()}


def parse_scenarios(questions: str, answers: str | None = None) -> Mapping[str, Scenario]:
    """The scenarios in a TOML text; those to practise with have their answers beside the questions."""
    right = msgspec.toml.decode(answers)["answer"] if answers else {}
    tables = [{**table, **right.get(table["id"], {})} for table in msgspec.toml.decode(questions)["scenario"]]
    return {scenario.id: scenario for scenario in msgspec.convert(_on_one_line(tables), list[Scenario])}


def _on_one_line(value: Any) -> Any:
    """Its texts on one line each; in the file they may be broken anywhere."""
    if isinstance(value, dict):
        return {name: _on_one_line(part) for name, part in value.items()}
    if isinstance(value, list):
        return [_on_one_line(part) for part in value]
    return " ".join(value.split()) if isinstance(value, str) else value


def draw_scenarios(seed: int = DEFAULT_SEED, scenarios: Mapping[str, Scenario] | None = None) -> tuple[Scenario, ...]:
    """The ten scenarios of a seed, in the order to show them."""
    if scenarios is None:
        scenarios = practice_scenarios() if seed == DEFAULT_SEED else graded_scenarios()
    chosen = _rank_names(f"{seed}/draw", scenarios)[:DRAWN]
    return tuple(scenarios[name] for name in _rank_names(f"{seed}/order", chosen))


def reasons_as_shown(scenario: Scenario, seed: int = DEFAULT_SEED) -> tuple[tuple[str, str], ...]:
    """The reasons of a scenario, id and text, shuffled: their places tell nothing."""
    return tuple((name, scenario.reasons[name]) for name in _rank_names(f"{seed}/{scenario.id}", scenario.reasons))


def _rank_names(salt: str, names: Iterable[str]) -> list[str]:
    return sorted(names, key=lambda name: hashlib.sha256(f"{salt}/{name}".encode()).digest())


class Questions:
    """The scenarios of one seed; a notebook shows them as HTML, anything else as text."""

    def __init__(self, seed: int = DEFAULT_SEED) -> None:
        self.seed = seed
        self.scenarios = draw_scenarios(seed)

    def form(self) -> str:
        """The answers as Python, one empty pair for each scenario, to be copied."""
        return "\n".join(["answers = {", *(f'    "{scenario.id}": ("", ""),' for scenario in self.scenarios), "}"])

    def sheet(self, answers: Mapping[str, tuple[str, str]] | None = None) -> str:
        """The answers as a Python file: all scenarios and reasons as comments, with a pair under each."""
        lines = [_HEAD, "answers = {"]
        for number, scenario in enumerate(self.scenarios, start=1):
            pattern, reason = (answers or {}).get(scenario.id, ("", ""))
            lines += [f"    # ---- {number}. {scenario.title} ----", *wrap_text(scenario.text, "    # ", "    # ")]
            for name, text in reasons_as_shown(scenario, self.seed):
                lines += wrap_text(f"{name}: {text}", "    #   - ", "    #     ")
            lines.append(f'    "{scenario.id}": ("{pattern}", "{reason}"),')
        return "\n".join([*lines, "}", ""])

    def __repr__(self) -> str:
        parts = ["\n".join(wrap_text(_ASKED))]
        for number, scenario in enumerate(self.scenarios, start=1):
            lines = [f"{number}. {scenario.title}  [{scenario.id}]", *wrap_text(scenario.text, "   ", "   ")]
            for name, text in reasons_as_shown(scenario, self.seed):
                lines += wrap_text(f"{name}: {text}", "   - ", "     ")
            parts.append("\n".join(lines))
        return "\n\n".join(parts)

    def _repr_html_(self) -> str:
        return str(render_template(_TEMPLATE, questions=self, asked=_ASKED, reasons=reasons_as_shown))


def show(seed: int = DEFAULT_SEED) -> Questions:
    """The ten scenarios of a learner, to be the last line of a cell."""
    if not isinstance(seed, int) or isinstance(seed, bool):
        raise TypeError(f"The seed must be a whole number, such as seed=17, not {seed!r}.")
    return Questions(seed)
