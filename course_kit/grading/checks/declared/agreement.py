"""Whether the parts of an exercise agree: its points with those of its checks, its checks with sentences and hints."""

from __future__ import annotations

import math
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from course_kit.grading.checks.declared.kinds import PYTHON
from course_kit.grading.checks.declared.reading import CHECKS, tables_of
from course_kit.grading.diagnosis import catalogue
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.declared.lines import Lines
    from course_kit.grading.checks.declared.mistakes import MistakeList
    from course_kit.grading.checks.declared.python_checks import CheckFacts
    from course_kit.grading.plain_data import Record

SENTENCES = "sentences"


def require(checks: Sequence[CheckFacts], table: Record, lines: Lines, mistakes: MistakeList, *, whole: bool) -> None:
    """Find what does not agree.

    Args:
        checks: of the exercise, the declared ones and the others.
        table: the exercise.toml.
        lines: where its parts stand.
        mistakes: gets what is wrong.
        whole: whether these are all checks; else nothing is said about what others may have.
    """
    _marks(checks, table, lines, mistakes, whole=whole)
    _points(checks, table, lines, mistakes, whole=whole)
    _ids(checks, mistakes, whole=whole)
    _sentences(checks, table, lines, mistakes, whole=whole)
    _hints(checks, table, mistakes)
    if whole:
        _hint_names(checks, table, lines, mistakes)


def declared_facts(table: Record, lines: Lines, facts: type[CheckFacts]) -> list[CheckFacts]:
    """What the `[[checks]]` say, those with mistakes in other keys included, as far as it can be used.

    Args:
        table: the exercise.toml.
        lines: where its parts stand.
        facts: the class.
    """
    found = []
    for number, one in enumerate(tables_of(table, CHECKS)):
        name, points = one.get("id"), one.get("points")
        if one.get("kind") == PYTHON:
            continue
        if not isinstance(name, str) or isinstance(points, bool) or not isinstance(points, (int, float)):
            continue
        line = lines.of_table(CHECKS, number)
        found.append(facts(name, float(points), _names(one, "depends_on"), _names(one, "proves"), line))
    return found


def _names(table: Record, key: str) -> tuple[str, ...]:
    value = table.get(key)
    return tuple(map(str, value)) if isinstance(value, list) else ()


def _marks(checks: Sequence[CheckFacts], table: Record, lines: Lines, mistakes: MistakeList, *, whole: bool) -> None:
    """What marks the place of a check in Python says which, and nothing that is said there."""
    known = {one.id: one for one in checks if one.path is not None}
    seen: set[str] = set()
    for number, mark in enumerate(tables_of(table, CHECKS)):
        if mark.get("kind") != PYTHON:
            continue
        name, more = str(mark.get("id", "")), sorted(set(mark) - {"id", "kind"})
        if more:
            text = f"'{more[0]}' of a check in Python stands beside its function, not here."
            mistakes.add(lines.within(CHECKS, number, more[0]), text)
        if not name:
            mistakes.add(lines.of_table(CHECKS, number), "'id' is missing: the name of the check's function.")
        elif "grader" not in table or (whole and name not in known):
            told = did_you_mean(name, known) or ' Name the file or module with it: grader = "checks.py".'
            mistakes.add(lines.within(CHECKS, number, "id"), f"No check in Python is called '{name}'.{told}")
        elif name in seen:
            mistakes.add(lines.within(CHECKS, number, "id"), f"The check '{name}' stands here twice.")
        seen.add(name)


def _points(checks: Sequence[CheckFacts], table: Record, lines: Lines, mistakes: MistakeList, *, whole: bool) -> None:
    total, wanted = math.fsum(one.points for one in checks), float(table["points"])
    if whole and not math.isclose(total, wanted):
        parts = " + ".join(f"{one.points:g}" for one in checks) or "none"
        text = f"'points' is {wanted:g}, but the points of the checks are {parts} = {total:g}. Make them agree."
        mistakes.add(lines.of_key("points"), text)


def _ids(checks: Sequence[CheckFacts], mistakes: MistakeList, *, whole: bool) -> None:
    known: dict[str, CheckFacts] = {}
    for one in checks:
        if one.id in known:
            first = f"the one on line {known[one.id].line}"
            mistakes.add(one.line, f"Two checks have the id '{one.id}': this one and {first}. Rename one.", one.path)
        known.setdefault(one.id, one)
    for one in checks:
        for name in one.depends_on:
            if whole and name not in known:
                text = f"The check '{one.id}' depends on '{name}', but no check has this id.{did_you_mean(name, known)}"
                mistakes.add(one.line, text, one.path)
    for circle in _circles(known):
        chain = " -> ".join([*circle, circle[0]])
        begin = known[circle[0]]
        mistakes.add(begin.line, f"These checks depend on each other in a circle: {chain}.", begin.path)


def _circles(known: dict[str, CheckFacts]) -> list[list[str]]:
    """A circle of dependence for each check that is in one, unless one before it has named it."""
    found: list[list[str]] = []
    for start in known:
        if not any(start in circle for circle in found) and (circle := _way_back(start, known)):
            found.append(circle)
    return found


def _way_back(start: str, known: dict[str, CheckFacts]) -> list[str]:
    """The shortest way along dependences from a check to itself; empty when there is none."""
    before: dict[str, str] = {}
    waiting = [start]
    while waiting:
        name = waiting.pop(0)
        for needed in known[name].depends_on if name in known else ():
            if needed == start:
                way = [name]
                while way[-1] != start:
                    way.append(before[way[-1]])
                return way[::-1]
            if needed not in before:
                before[needed] = name
                waiting.append(needed)
    return []


def _sentences(
    checks: Sequence[CheckFacts], table: Record, lines: Lines, mistakes: MistakeList, *, whole: bool
) -> None:
    if SENTENCES not in table:
        return
    tables = tables_of(table, SENTENCES)
    known = {str(one.get("id", "")): number for number, one in enumerate(tables)}
    for one in checks:
        if not one.proves:
            text = f"The check '{one.id}' proves no sentence of the task. Name one: proves = [\"...\"]."
            mistakes.add(one.line, text, one.path)
        for name in one.proves:
            if name not in known:
                told = f"The check '{one.id}' proves the sentence '{name}', but the task has none of this id."
                mistakes.add(one.line, told + did_you_mean(name, known), one.path)
    proven = {name for one in checks for name in one.proves}
    for name, number in known.items():
        if whole and name not in proven and not tables[number].get("freedom"):
            text = (
                f"No check proves the sentence '{name}'. Name it in the 'proves' of a check, or, if it grants a "
                'freedom, name the program that uses it: freedom = "...".'
            )
            mistakes.add(lines.of_table(SENTENCES, number), text)


def _hints(checks: Sequence[CheckFacts], table: Record, mistakes: MistakeList) -> None:
    topics = [str(name) for hint in tables_of(table, "hints") for name in hint.get("for", [])]
    for one in checks:
        if not any(fnmatchcase(one.id, topic) for topic in topics):
            text = f"The check '{one.id}' has no hint. Add [[hints]] with for = [\"{one.id}\"] and a text."
            mistakes.add(one.line, text, one.path)


def _hint_names(checks: Sequence[CheckFacts], table: Record, lines: Lines, mistakes: MistakeList) -> None:
    """Each hint is for a check or a diagnosis that there is; `*_reason` stands for all that end so."""
    known = [*(one.id for one in checks), *catalogue.catalogue()]
    for number, hint in enumerate(tables_of(table, "hints")):
        for name in map(str, hint.get("for", [])):
            if not any(fnmatchcase(one, name) for one in known):
                text = f"A hint is for '{name}', but no check and no diagnosis is called so.{did_you_mean(name, known)}"
                mistakes.add(lines.of_table("hints", number), text)
