"""The table of an intake: which file was chosen for whom, why, and what else was there; every file is in it once."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.classroom.exports.texts import csv_text, lines_of_table
from course_kit.classroom.records import Entry
from course_kit.environment import write_atomically
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.intake.collecting import Intake

FILE = "intake.csv"
HEADER = ("student", "name", "exercise", "file", "why", "also handed in", "late", "look at it")
_NOTHING = "nothing was handed in for it"
_WIDEST = (28, 24, 60, 90, 60)  # columns of the text


def intake_rows(found: Intake) -> list[Entry]:
    """The rows: students in order, then without a student what belongs to no submission."""
    names = {entry.student: entry.name for entry in (*found.entries, *found.others)}
    dropped = dict(found.dropped)
    absent = {person.student: person.name for person in found.roster.absent} if found.roster else {}
    rows = [replace(entry, source=one_line(entry.source)) for entry in found.entries]
    rows += [
        Entry(student, exercise, "", names.get(student, ""), why=dropped.get(student, _NOTHING), worry="not graded")
        for student, exercise in found.missing
        if student not in absent
    ]
    rows += [Entry(student, "", "", name, why="not handed in") for student, name in absent.items()]
    rows.sort(key=lambda row: (row.student, row.exercise))
    return rows + [Entry("", "", one_line(path), why=one_line(reason)) for path, reason in found.left]


def write_intake(found: Intake, out: Path) -> Path:
    """Write the table as CSV into a run's output folder."""
    body = [_cells_of(row) for row in intake_rows(found)]
    write_atomically(out / FILE, csv_text([HEADER, *body], mark=True), durable=False)
    return out / FILE


def format_intake(found: Intake) -> str:
    """The table for a terminal: students only, long cells cut."""
    header = ("student", "exercise", "file", "why", "also handed in")
    body = [
        (_label_student(row), row.exercise, row.source or "-", row.why, "; ".join(row.others))
        for row in intake_rows(found)
        if row.student
    ]
    return "\n".join(lines_of_table([list(map(_cut, row, _WIDEST)) for row in (header, *body)]))


def _cells_of(row: Entry) -> tuple[str, ...]:
    also, late = "; ".join(row.others), "yes" if row.late else ""
    return row.student, row.name, row.exercise, row.source, row.why, also, late, row.worry


def _label_student(row: Entry) -> str:
    return f"{row.student} ({row.name})" if row.name and row.name != row.student else row.student


def _cut(cell: str, widest: int) -> str:
    return cell if len(cell) <= widest else f"{cell[: widest - 1]}…"
