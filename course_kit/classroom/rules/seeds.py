"""`--seeds`: a seed for each student, so that each draws questions of their own where an exercise asks some."""

from __future__ import annotations

import secrets
from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake import roster
from course_kit.classroom.rules.people import Mistakes, read_rows
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from course_kit.classroom.records import Entry
    from course_kit.classroom.rules.people import People

COLUMNS = ("student", "seed")
_BITS = 31


@dataclass(frozen=True)
class Seeds:
    """What stands in the file: seed and line of each student."""

    path: Path
    found: Mapping[str, tuple[int, int]]

    def seed_for(self, entry: Entry) -> int | None:
        """The seed of whoever handed something in; None where the file has none."""
        return self.found[entry.student][0] if entry.student in self.found else None

    def of_class(self, entries: Iterable[Entry], people: People) -> Seeds:
        """The seeds by the students of a class, whom the file may call by any of their names."""
        mistakes = Mistakes(self.path)
        lines = ((line, called, "", seed) for called, (seed, line) in self.found.items())
        by_student = people.by_student(lines, mistakes, "{called} stands in line {line} already, by another name")
        found = {student: said for (student, _), said in by_student.items()}
        if absent := sorted({entry.student for entry in entries} - set(found)):
            mistakes.add_of_all(f"there is no seed for: {', '.join(absent)}")
        mistakes.require_none()
        return replace(self, found=found)


def read_seeds(path: Path) -> Seeds:
    """Read the file: the columns student and seed."""
    mistakes = Mistakes(path)
    found: dict[str, tuple[int, int]] = {}
    for row in read_rows(path, COLUMNS, headless=True):
        student, text = row.cells["student"], row.cells["seed"]
        if not student:
            mistakes.add(row.line, "the student is missing")
        elif student in found:
            mistakes.add(row.line, f"{student} stands in line {found[student][1]} already")
        elif not (text.isascii() and text.isdecimal()) or int(text) >= 1 << _BITS:
            mistakes.add(row.line, f"the seed '{text}' is not a whole number from 0 to {(1 << _BITS) - 1}")
        else:
            found[student] = (int(text), row.line)
    mistakes.require_none()
    return Seeds(path, found)


def draw_seeds(students: Iterable[str], before: Seeds | None = None) -> dict[str, int]:
    """A seed for each student, no two the same; whoever has one already keeps it."""
    drawn = {student: seed for student, (seed, _) in before.found.items()} if before else {}
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
