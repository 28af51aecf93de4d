"""The declared checks of an exercise that is being loaded, and everything in which its parts do not agree."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.checks.declared import agreement, reading
from course_kit.grading.checks.declared.definitions import also_in
from course_kit.grading.checks.declared.lines import Lines
from course_kit.grading.checks.declared.mistakes import MistakeList
from course_kit.grading.checks.declared.python_checks import CheckFacts, facts_of
from course_kit.grading.exercise_folders import INTERFACES

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.grading.plain_data import Record

_PYTHON, _ENVIRONMENT = ".py", "environment"


def load(text: str, table: Record, path: Path) -> tuple[tuple[Declaration, ...], tuple[str, ...]]:
    """The declared checks of an exercise, and the ids by which its checks are put in order.

    Args:
        text: of its exercise.toml.
        table: what that says.
        path: of that file.

    Raises:
        GradingError: the author has made mistakes; with all of them, each with its line.
    """
    lines, mistakes = Lines(text), MistakeList(path)
    with also_in(path.parent / INTERFACES):
        found = reading.read(table, lines, mistakes)
    grader = str(table.get("grader", ""))
    python = facts_of(path.parent / grader) if grader.endswith(_PYTHON) else [] if not grader else None
    facts = agreement.declared_facts(table, lines, CheckFacts) + (python or [])
    if facts or not grader:
        agreement.require(facts, table, lines, mistakes, whole=python is not None)
    mistakes.require_none()
    return found, reading.order_of(table)


def variables(table: Record) -> dict[str, str]:
    """The environment variables that a submission is started with: the texts of `[environment]`."""
    found = table.get(_ENVIRONMENT, {})
    return {name: str(value) for name, value in found.items()} if isinstance(found, dict) else {}
