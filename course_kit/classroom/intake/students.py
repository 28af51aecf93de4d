"""Which entries are one student's, and what each student is called: two stay two, whatever they are called."""

from __future__ import annotations

import hashlib
import itertools
import re
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake.listing import FOLDER
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from course_kit.classroom.intake.layouts import Unit

_NAMELESS = "unnamed"
_MARK = 8  # hexadecimal digits that tell two apart who look the same
# Marks that change how, or whether, the letter before them is drawn; without one two names look the same.
_INVISIBLE = re.compile("[\u034f\u17b4\u17b5\u180b-\u180f\ufe00-\ufe0f\U000e0100-\U000e01ef\u200c\u200d]")

Key = tuple[str, str]


def by_name(units: Iterable[Unit], exercises: Sequence[str]) -> dict[str, list[Unit]]:
    """Each student's entries, by a name that is printable and nobody else's."""
    own: dict[Key, list[Unit]] = defaultdict(list)
    for unit in _without_doubtful([_without_exercise(unit, exercises) for unit in units]):
        own[_key(unit)].append(unit)
    names = _names(own)
    return {names[key]: own[key] for key in sorted(own, key=names.__getitem__)}


def across_downloads(units: Sequence[Unit], layout: str, exercises: int) -> list[Unit]:
    """Entries of several downloads of one class, so that what is one student's has one identifier."""
    numbers: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    for unit in units:
        if not unit.odd:
            numbers[unit.name][unit.download].add(unit.student)
    if layout != "moodle" or _is_of_one_assignment(numbers.values(), units, exercises):
        return list(units)
    found = []
    for unit in units:
        if unit.odd:
            found.append(unit)
        elif all(len(of_one) == 1 for of_one in numbers[unit.name].values()):
            found.append(replace(unit, student=unit.name))
        else:
            student = f"{unit.name} {unit.student} of {unit.download}"
            odd = f"'{unit.name}' has several participant numbers, so nothing joins them with other downloads"
            found.append(replace(unit, student=student, odd=odd))
    return found


def _is_of_one_assignment(numbers: Iterable[Mapping[str, set[str]]], units: Sequence[Unit], exercises: int) -> bool:
    """Whether all who are in several downloads have the same numbers there, and somebody is or one exercise was set."""
    twice = [list(of_name.values()) for of_name in numbers if len(of_name) > 1]
    agree = all(one == of_name[0] for of_name in twice for one in of_name)
    return agree and len({unit.exercise for unit in units}) == 1 and (bool(twice) or exercises == 1)


def _key(unit: Unit) -> Key:
    return (f"{unit.item.kind == FOLDER} {unit.name}" if unit.odd else "", unit.student)


def _without_exercise(unit: Unit, exercises: Sequence[str]) -> Unit:
    """`jane_EXERCISE.py` is jane's; a file that is called like the exercise alone stays as it is."""
    if unit.item.kind == FOLDER:
        return unit
    for exercise in exercises:
        student = unit.student.removesuffix(exercise).rstrip(" _.-")
        if unit.student.endswith(exercise) and student:
            return replace(unit, student=student)
    return unit


def _without_doubtful(units: list[Unit]) -> list[Unit]:
    """Where a platform's number stands beside two people's names, it is no one's number."""
    names: dict[str, set[str]] = defaultdict(set)
    for unit in units:
        if not unit.odd:
            names[unit.student].add(unit.name)
    found = []
    for unit in units:
        doubtful = not unit.odd and len(names[unit.student]) > 1 and "email" not in unit.platform
        odd = f"the number {unit.student} also belongs to another name"
        found.append(replace(unit, student=f"{unit.student} {unit.name}", platform={}, odd=odd) if doubtful else unit)
    return found


def _names(keys: Iterable[Key]) -> dict[Key, str]:
    """A name for each: their own where it can be, else with a mark that depends on nothing but the name itself."""
    alike: dict[str, list[Key]] = defaultdict(list)
    for key in sorted(keys):  # entries that fit come first
        alike[_INVISIBLE.sub("", _clean(key))].append(key)
    names: dict[Key, str] = {}
    marked: list[Key] = []
    for look, group in alike.items():
        plain = next((key for key in group if len(group) == 1 or key[1] == look), None)
        names.update((key, _clean(key)) for key in group)
        marked += [key for key in group if key != plain]
    return _with_marks(names, marked)


def _with_marks(names: dict[Key, str], marked: list[Key]) -> dict[Key, str]:
    """Add the marks; others in the case that somebody is called like another one with a mark."""
    for attempt in itertools.count():
        found = {**names, **{key: f"{names[key]}~{_mark(key, attempt)}" for key in marked}}
        if len(set(found.values())) == len(found):
            return found
    raise AssertionError  # never reached: each name in the way costs one attempt


def _mark(key: Key, attempt: int) -> str:
    return hashlib.sha256("\0".join((*key, str(attempt))).encode(errors="surrogatepass")).hexdigest()[:_MARK]


def _clean(key: Key) -> str:
    return one_line(key[1]) or _NAMELESS
