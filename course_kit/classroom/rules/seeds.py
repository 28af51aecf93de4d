"""`--seeds`: a seed for each student, so that each gets different questions where an exercise draws them."""

from __future__ import annotations

import secrets
from collections import Counter
from typing import TYPE_CHECKING, TypeAlias

from course_kit.classroom.intake import roster
from course_kit.classroom.rules.people import Mistakes, StudentTable, read_rows, require_none
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from course_kit.classroom.records import Entry
    from course_kit.classroom.rules.people import People

COLUMNS = ("student", "seed")
_BITS = 31
Seeds: TypeAlias = StudentTable[int]  # the exercise is "", as a seed is for all


def match_class(seeds: Seeds, entries: Iterable[Entry], people: People) -> Seeds:
    """The seeds by the students of a class; each of them needs one."""
    found = seeds.match_people(people)
    if absent := sorted({entry.student for entry in entries if found.find(entry.student) is None}):
        found.mistakes.add_of_all(f"there is no seed for: {', '.join(absent)}")
    require_none([found.mistakes])
    return found


def read_seeds(path: Path) -> Seeds:
    """Read the file: the columns student and seed."""
    found: Seeds = StudentTable(Mistakes(path))
    for row in read_rows(path, COLUMNS, headless=True):
        text = row.cells["seed"]
        if not (text.isascii() and text.isdecimal()) or int(text) >= 1 << _BITS:
            found.mistakes.add(row.line, f"the seed '{text}' is not a whole number from 0 to {(1 << _BITS) - 1}")
        else:
            found.put(row, "", int(text))
    require_none([found.mistakes])
    return found


def draw_seeds(students: Iterable[str], before: Seeds | None = None) -> dict[str, int]:
    """A seed for each student, no two the same; whoever has one already keeps it."""
    drawn = {student: seed for (student, _), (seed, _) in before.said.items()} if before else {}
    taken = set(drawn.values())
    for student in students:
        if student not in drawn:
            while (seed := secrets.randbits(_BITS)) in taken:
                pass
            taken.add(seed)
            drawn[student] = seed
    return drawn


def students_of(path: Path, layout: str = "") -> list[str]:
    """The students of a class list, called as a class run with this layout calls them."""
    students = [person.student(layout) for person in roster.read_roster(path).people]
    if doubles := sorted(student for student, count in Counter(students).items() if count > 1):
        raise GradingError(f"{path} lists these more than once, and they cannot be told apart: {', '.join(doubles)}.")
    return students
