"""`--seeds`: a seed for each student, so that each draws questions of their own in exercise 4."""

from __future__ import annotations

import secrets
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.tables import Mistakes, read_rows, unknown
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping
    from pathlib import Path

COLUMNS = ("student", "seed")
_BITS = 31


@dataclass(frozen=True)
class Seeds:
    """What stands in the file: seed and line of each student."""

    path: Path
    found: Mapping[str, tuple[int, int]]

    def of(self, student: str) -> int:
        """A student's seed."""
        return self.found[student][0]

    def require_for(self, handed_in: Collection[str], students: Collection[str]) -> None:
        """See that the file fits the class.

        Args:
            handed_in: those who need a seed.
            students: everybody known.

        Raises:
            GradingError: somebody has no seed, or a line is about nobody of the class; all are named.
        """
        mistakes = Mistakes(self.path)
        for student, (_, line) in self.found.items():
            if student not in students:
                mistakes.add(line, unknown("student", student, students))
        if absent := sorted(set(handed_in) - set(self.found)):
            mistakes.found.append(f"there is no seed for: {', '.join(absent)}")
        mistakes.require_none()


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


def students_of(path: Path) -> list[str]:
    """The students of a roster: its column `student`, or the only one.

    Raises:
        GradingError: it cannot be read, has no such column, or names somebody twice or nobody.
    """
    mistakes = Mistakes(path)
    lines: dict[str, int] = {}
    for row in read_rows(path, ("student",)):
        student = row.cells["student"]
        if student in lines:
            mistakes.add(row.line, f"{student} stands in line {lines[student]} already")
        elif student:
            lines[student] = row.line
        else:
            mistakes.add(row.line, "the student is missing")
    mistakes.require_none()
    if not lines:
        raise GradingError(f"{path} names no student.")
    return list(lines)
