"""`overrides.csv`: scores that the instructor sets by hand, points that are added (`+1`), and comments for students.

The file lies in the folder of the results and is the instructor's: no run writes it, and each run reads it anew.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.rules.tables import Mistakes, read_rows, to_number, unknown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from course_kit.classroom.rules.people import People
    from course_kit.grading.exercise import Exercise

FILE = "overrides.csv"


@dataclass(frozen=True)
class Override:
    """One line of the file."""

    line: int  # its number
    student: str  # whom it is about
    exercise: str  # the exercise's id
    score: float | None  # the points instead of those of the checks; None when there is none
    added: float  # the points on top of those of the checks, written with a plus; 0 without any
    comment: str  # for the student


class Overrides:
    """All lines of the file."""

    def __init__(self, mistakes: Mistakes, found: Sequence[Override] = ()) -> None:
        self.mistakes = mistakes
        self._found = {(one.student, one.exercise): one for one in found}

    def find(self, student: str, exercise: str) -> Override | None:
        """What the instructor has set for a student and exercise."""
        return self._found.get((student, exercise))

    def of(self, people: People) -> Overrides:
        """The lines by the students of a class; who is not in it is a mistake."""
        mistakes = Mistakes(self.mistakes.path, [*self.mistakes.found])
        lines = ((one.line, one.student, one.exercise, one) for one in self._found.values())
        found = people.by_student(lines, mistakes, "{called} is {student}, who stands in line {line} already")
        return Overrides(mistakes, [replace(one, student=student) for (student, _), (one, _) in found.items()])


def read(path: Path, exercises: Sequence[Exercise]) -> Overrides:
    """Read the file."""
    mistakes = Mistakes(path)
    if not path.exists():
        return Overrides(mistakes)
    points = {one.id: one.points for one in exercises}
    found: dict[tuple[str, str], Override] = {}
    for row in read_rows(path, ("student", "exercise"), ("score", "comment")):
        student, exercise = row.cells["student"], row.cells["exercise"]
        text, comment = row.cells["score"], row.cells["comment"]
        score = to_number(text)
        if exercise not in points:
            mistakes.add(row.line, unknown("exercise", exercise, points))
        elif not student:
            mistakes.add(row.line, "the student is missing")
        elif (before := found.get((student, exercise))) is not None:
            mistakes.add(row.line, f"{student} and {exercise} stand in line {before.line} already")
        elif text and (score is None or not 0 <= score <= points[exercise]):
            mistakes.add(row.line, f"the score '{text}' is no number from 0 to {points[exercise]:g}")
        elif not text and not comment:
            mistakes.add(row.line, "it has neither a score nor a comment")
        else:
            adds = text.startswith("+")
            instead, added = (None, score or 0.0) if adds else (score, 0.0)
            found[student, exercise] = Override(row.line, student, exercise, instead, added, comment)
    return Overrides(mistakes, list(found.values()))
