"""`grades.csv`: a row for each student, for people and their spreadsheets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports.results import MISSING, by_student, name_of, score, total
from course_kit.classroom.exports.texts import csv_text
from course_kit.classroom.gradebook import outcome

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

FILE = "grades.csv"


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """The one table; a score is empty where the grader failed or nothing was handed in, and the status says which."""
    yield FILE, csv_text(_rows(book), mark=True)


def _rows(book: Gradebook) -> Iterator[list[str | float | None]]:
    header: list[str | float | None] = ["student", "name"]
    for exercise in book.exercises:
        header += [f"{exercise.id} {column}" for column in ("score", "max", "status", "late", "checks", "remarks")]
    yield [*header, "total", "total max"]
    full = sum(exercise.points for exercise in book.exercises)
    for student, records in by_student(book).items():
        row: list[str | float | None] = [student, name_of(records, book.names.get(student, ""))]
        for exercise in book.exercises:
            row += _cells(records.get(exercise.id), exercise.points)
        yield [*row, total(records), full]


def _cells(record: Record | None, points: float) -> list[str | float | None]:
    if record is None:
        return [None, points, MISSING, None, None, None]
    late = "late" if record.is_late else None
    checks = None if record.status == "error" else record.graded_score
    return [score(record), record.max_score, outcome(record), late, checks, " ".join(record.remarks) or None]
