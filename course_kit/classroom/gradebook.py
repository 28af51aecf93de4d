"""A class's results as a whole: what exports and the class page are made from.

What counts of a submission stands in its record, and nowhere else: `score`, `passed`, `has_grade`, `is_late` and
`remarks` are those after lateness, penalty and the instructor's override; `graded_score` is that of the checks.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import Entry, Record
    from course_kit.grading.exercise import Exercise
    from course_kit.grading.readings import Readings


@dataclass(frozen=True)
class Gradebook:
    """The results of a class run."""

    exercises: tuple[Exercise, ...]  # the exercises that were set, in the order of the course
    records: tuple[Record, ...]  # one for each student and exercise that was handed in, by student and exercise
    missing: tuple[tuple[str, str], ...] = ()  # student and exercise of those who handed in something else only
    left: tuple[tuple[str, str], ...] = ()  # path and reason of each file that is no submission
    layout: str = ""  # the layout the submissions were in
    seed: int = 0  # what the checks drew from
    complete: bool = True  # whether every submission has its record; False after Ctrl-C
    root: Path | None = None  # the folder the entries' sources are relative to; None where they are not at hand
    readings: Readings | None = None  # who has read them, and remembers; None where nobody has
    odd: tuple[tuple[str, str], ...] = ()  # student and reason of those whose entry does not fit the layout
    # student and reason of those who handed in something of which nothing could be graded, or not all
    dropped: tuple[tuple[str, str], ...] = ()
    # identifier and name of those on the roster who handed in nothing; they are among `missing`, too
    absent: tuple[tuple[str, str], ...] = ()
    unknown: tuple[tuple[str, str], ...] = ()  # student and reason of those who do not match the roster
    earlier: frozenset[str] = (
        frozenset()
    )  # ids of the exercises that an earlier run has graded: their files are elsewhere
    canvas_assignments: tuple[str, ...] = ()  # see `Roster`
    others: tuple[Entry, ...] = ()  # who has no submission at all, in entries without exercise and source

    @property
    def entries(self) -> tuple[Entry, ...]:
        """What everybody handed in, and who handed in nothing."""
        return (*(record.entry for record in self.records), *self.others)

    @property
    def names(self) -> dict[str, str]:
        """The names of those without a submission, by student."""
        return {one.student: one.name for one in self.others if one.name}

    @property
    def students(self) -> list[str]:
        """Everybody who handed in anything, sorted."""
        return sorted({record.entry.student for record in self.records} | {student for student, _ in self.missing})

    def graded(self, exercise_id: str | None = None) -> list[Record]:
        """The records that hold a grade, of one exercise or of all; see `Record.has_grade`."""
        of = self.records if exercise_id is None else self.of(exercise_id)
        return [record for record in of if record.has_grade]

    @property
    def not_graded(self) -> list[Record]:
        """The records of submissions that have to be graded again, as the grader itself failed."""
        return [record for record in self.records if not record.has_grade]

    def of(self, exercise_id: str) -> list[Record]:
        """The records of one exercise, by student."""
        return [record for record in self.records if record.entry.exercise == exercise_id]

    def tally(self) -> Counter[str]:
        """How many passed, did not pass, crashed, were unreadable, or met an error of the grader."""
        return Counter(outcome(record) for record in self.records)


def outcome(record: Record) -> str:
    """A record in a word or two: passed, not passed, crashed, unreadable or error."""
    if record.status == "graded" or record.passed or record.adjustment.override is not None:
        return "passed" if record.passed else "not passed"
    return record.status
