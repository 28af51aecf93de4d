"""`overrides.csv`: scores set by hand, for an exercise or for one check, added points (`+1`), comments for students.

The file lies in the folder of the results and is the instructor's: no run writes it, and each run reads it anew.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.rules.tables import Mistakes, read_rows, to_number, unknown

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
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
    checks: tuple[tuple[str, float], ...] = ()  # ids of checks, each with the points instead of those it gave


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
    lines: dict[tuple[str, str, str], int] = {}
    for row in read_rows(path, ("student", "exercise"), ("score", "comment", "check")):
        student, exercise, check = row.cells["student"], row.cells["exercise"], row.cells["check"]
        text, comment = row.cells["score"], row.cells["comment"]
        score = to_number(text)
        if exercise not in points:
            mistakes.add(row.line, unknown("exercise", exercise, points))
        elif not student:
            mistakes.add(row.line, "the student is missing")
        elif (line := lines.setdefault((student, exercise, check), row.line)) != row.line:
            what = f"the check {check}" if check else exercise
            mistakes.add(row.line, f"{student} and {what} stand in line {line} already")
        elif text and (score is None or not 0 <= score <= points[exercise]):
            mistakes.add(row.line, f"the score '{text}' is no number from 0 to {points[exercise]:g}")
        elif check and (score is None or text.startswith("+")):
            mistakes.add(row.line, f"the check {check} needs the points that it is worth, such as 1.5")
        elif not text and not comment:
            mistakes.add(row.line, "it has neither a score nor a comment")
        else:
            before = found.get((student, exercise), Override(row.line, student, exercise, None, 0.0, ""))
            found[student, exercise] = _with_row(before, row.cells, score)
    return Overrides(mistakes, list(found.values()))


def _with_row(before: Override, cells: Mapping[str, str], score: float | None) -> Override:
    """What the lines before say of a student and exercise, and one more."""
    comments = " ".join(filter(None, (before.comment, cells["comment"])))
    if cells["check"]:
        return replace(before, comment=comments, checks=(*before.checks, (cells["check"], score or 0.0)))
    if cells["score"].startswith("+"):
        return replace(before, comment=comments, added=score or 0.0)
    return replace(before, comment=comments, score=score)
