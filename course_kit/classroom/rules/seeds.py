"""`--seeds`: a seed for each student, so that each draws questions of their own where an exercise asks some."""

from __future__ import annotations

import secrets
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.intake import roster
from course_kit.classroom.rules.tables import Mistakes, read_rows, unknown
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping
    from pathlib import Path

    from course_kit.classroom.records import Entry

COLUMNS = ("student", "seed")
_BITS = 31


@dataclass(frozen=True)
class Seeds:
    """What stands in the file: seed and line of each student."""

    path: Path
    found: Mapping[str, tuple[int, int]]

    def of(self, entry: Entry) -> int | None:
        """The seed of whoever handed something in; None where the file has none.

        It may list them by any of their names: that of the reports, their own, or what a platform calls them.
        """
        return next((self.found[name][0] for name in _names(entry) if name in self.found), None)

    def require_for(self, entries: Collection[Entry], others: Collection[str]) -> None:
        """See that the file fits the class.

        Args:
            entries: what was handed in; whoever did so needs a seed.
            others: names of everybody else who is known, as those on the roster.

        Raises:
            GradingError: somebody has no seed, or a line is about nobody of the class; all are named.
        """
        mistakes = Mistakes(self.path)
        known = {name for entry in entries for name in _names(entry)} | set(others)
        for student, (_, line) in self.found.items():
            if student not in known:
                mistakes.add(line, unknown("student", student, known))
        if absent := sorted({entry.student for entry in entries if self.of(entry) is None}):
            mistakes.found.append(f"there is no seed for: {', '.join(absent)}")
        mistakes.require_none()


def _names(entry: Entry) -> list[str]:
    return [name for name in (entry.student, entry.name, *entry.platform.values()) if name]


def read(path: Path) -> Seeds:
    """Read the file: the columns student and seed.

    Raises:
        GradingError: it cannot be read, or has mistakes; all of them are named with their lines.
    """
    mistakes = Mistakes(path)
    found: dict[str, tuple[int, int]] = {}
    for row in read_rows(path, COLUMNS, headless=True):
        student, text = row.cells["student"], row.cells["seed"]
        if not student:
            mistakes.add(row.line, "the student is missing")
        elif student in found:
            mistakes.add(row.line, f"{student} stands in line {found[student][1]} already")
        elif not (text.isascii() and text.isdecimal()) or int(text) >= 1 << _BITS:
            mistakes.add(row.line, f"the seed '{text}' is no whole number from 0 to {(1 << _BITS) - 1}")
        else:
            found[student] = (int(text), row.line)
    mistakes.require_none()
    return Seeds(path, found)


def draw(students: Iterable[str], before: Seeds | None = None) -> dict[str, int]:
    """A seed for each student, no two the same; whoever has one already keeps it.

    Args:
        students: everybody, without doubles.
        before: seeds that were handed out.
    """
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
    """The students of a class list, called as a class run with this layout calls them.

    Raises:
        GradingError: it cannot be read, lists nobody, or two of one name and nothing else to tell them apart.
    """
    students = [person.student(layout) for person in roster.read(path).people]
    if doubles := sorted(student for student, count in Counter(students).items() if count > 1):
        raise GradingError(f"{path} lists these more than once, and they cannot be told apart: {', '.join(doubles)}.")
    return students
