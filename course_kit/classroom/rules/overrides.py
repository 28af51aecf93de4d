"""`overrides.csv`: scores that the instructor sets by hand, and comments for students.

The file lies in the folder of the results and is the instructor's: no run writes it, and each run reads it anew.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.rules.tables import Mistakes, read_rows, to_number, unknown

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from course_kit.grading.exercise import Exercise

FILE = "overrides.csv"


@dataclass(frozen=True)
class Override:
    """One line of the file.

    Attributes:
        line: its number.
        student: whom it is about.
        exercise: the exercise's id.
        score: the points instead of those of the checks; None when only a comment is given.
        comment: for the student.
    """

    line: int
    student: str
    exercise: str
    score: float | None
    comment: str


class Overrides:
    """All lines of the file."""

    def __init__(self, path: Path, found: Sequence[Override] = ()) -> None:
        self._path = path
        self._found = {(one.student, one.exercise): one for one in found}

    def find(self, student: str, exercise: str) -> Override | None:
        """What the instructor has set for a student and exercise."""
        return self._found.get((student, exercise))

    def require_known(self, students: Iterable[str]) -> None:
        """See that nobody is misspelled, before anything is graded.

        Raises:
            GradingError: a line is about a student who is not in the class.
        """
        known = set(students)
        mistakes = Mistakes(self._path)
        for one in self._found.values():
            if one.student not in known:
                mistakes.add(one.line, unknown("student", one.student, known))
        mistakes.require_none()


def read(path: Path, exercises: Sequence[Exercise]) -> Overrides:
    """Read the file.

    Args:
        path: the file, with the columns student, exercise, score and comment; where there is none nothing is set.
        exercises: those that were set.

    Raises:
        GradingError: it cannot be read or has mistakes; all of them are named, with their lines.
    """
    if not path.exists():
        return Overrides(path)
    points = {one.id: one.points for one in exercises}
    mistakes = Mistakes(path)
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
            found[student, exercise] = Override(row.line, student, exercise, score, comment)
    mistakes.require_none()
    return Overrides(path, list(found.values()))
