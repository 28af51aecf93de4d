"""nbgrader: the columns of its `nbgrader export`, for whatever reads that file."""

from __future__ import annotations

from datetime import timezone
from typing import TYPE_CHECKING

from course_kit.classroom.exports.results import by_student, name_of, platform_of, score
from course_kit.classroom.exports.texts import Identifier, csv_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from datetime import datetime

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record
    from course_kit.grading.exercise import Exercise

FILE = "exports/nbgrader.csv"
HEADER = (
    "assignment",
    "duedate",
    "timestamp",
    "student_id",
    "last_name",
    "first_name",
    "email",
    "raw_score",
    "late_submission_penalty",
    "score",
    "max_score",
)


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """The one table: as nbgrader does it, a row for each assignment and student, and 0 for what is missing."""
    yield FILE, csv_text(_rows(book))


def _rows(book: Gradebook) -> Iterator[Sequence[str | float | None]]:
    yield HEADER
    students = by_student(book)
    for exercise in book.exercises:
        for student, records in students.items():
            if exercise.id in records and score(records[exercise.id]) is None:
                continue
            yield _row(exercise, student, records, _assignment(book, records, exercise))


def _assignment(book: Gradebook, records: dict[str, Record], exercise: Exercise) -> str:
    """The assignment's name, which nbgrader's folders tell; with several exercises theirs, to keep them apart."""
    known = platform_of(records, "nbgrader_assignment")
    return known if known and len(book.exercises) == 1 else exercise.id


def _row(exercise: Exercise, student: str, records: dict[str, Record], assignment: str) -> Sequence[str | float | None]:
    record = records.get(exercise.id)
    points = 0.0 if record is None else score(record)
    raw = 0.0 if record is None else record.graded_score
    penalty = 0.0 if record is None else record.adjustment.penalty
    due, submitted = ("", "") if record is None else (_utc(record.adjustment.due), _utc(record.adjustment.submitted))
    last, _, first = name_of(records).partition(",")  # nobody can tell which part of "Li Na" is which
    # Whatever reads the file finds a student by the identifier, which has to stand there exactly.
    return [
        assignment,
        due,
        submitted,
        Identifier(student),
        last.strip(),
        first.strip(),
        "",
        raw,
        penalty,
        points,
        exercise.points,
    ]


def _utc(moment: datetime | None) -> str:
    """As nbgrader writes it: UTC, without saying so."""
    return "" if moment is None else f"{moment.astimezone(timezone.utc):%Y-%m-%d %H:%M:%S}"
