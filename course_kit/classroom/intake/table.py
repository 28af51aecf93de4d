"""The table of an intake: which file was chosen for whom, why, and what else was there; every file is in it once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.exports.texts import csv_text, lines_of_table
from course_kit.environment import write_atomically
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.intake.collecting import Intake

FILE = "intake.csv"
HEADER = ("student", "name", "exercise", "file", "why", "also handed in", "late", "look at it")
_NOTHING = "nothing was handed in for it"
_WIDEST = (28, 24, 60, 90, 60)  # columns of the text


@dataclass(frozen=True)
class IntakeRow:
    """One file, or the lack of one; without a student it is a file that nobody's submission is."""

    student: str = ""  # who
    name: str = ""  # their own name, where it is known
    exercise: str = ""  # for which exercise
    file: str = ""  # what was chosen; empty when there is nothing
    why: str = ""  # why it was chosen, or why nothing was
    also: str = ""  # what else was there
    late: bool = False  # whether the platform marked it as late
    worry: str = ""  # why somebody should look at it


def intake_rows(found: Intake) -> list[IntakeRow]:
    """The rows: students in order, then what belongs to no submission."""
    names = {entry.student: entry.name for entry in (*found.entries, *found.others)}
    dropped = dict(found.dropped)
    absent = {one.student: one.name for one in found.roster.absent} if found.roster else {}
    table = [
        IntakeRow(
            entry.student,
            entry.name,
            entry.exercise,
            one_line(entry.source),
            entry.why,
            "; ".join(entry.others),
            entry.late,
            entry.worry,
        )
        for entry in found.entries
    ]
    table += [
        IntakeRow(student, names.get(student, ""), exercise, why=dropped.get(student, _NOTHING), worry="not graded")
        for student, exercise in found.missing
        if student not in absent
    ]
    table += [IntakeRow(student, name, why="not handed in") for student, name in absent.items()]
    table.sort(key=lambda row: (row.student, row.exercise))
    return table + [IntakeRow(file=one_line(path), why=one_line(reason)) for path, reason in found.left]


def write_intake(found: Intake, out: Path) -> Path:
    """Write the table as CSV into a run's output folder."""
    body = [
        (row.student, row.name, row.exercise, row.file, row.why, row.also, "yes" if row.late else "", row.worry)
        for row in intake_rows(found)
    ]
    write_atomically(out / FILE, csv_text([HEADER, *body], mark=True), durable=False)
    return out / FILE


def format_intake(found: Intake) -> str:
    """The table for a terminal: students only, long cells cut."""
    header = ("student", "exercise", "file", "why", "also handed in")
    body = [(_who(row), row.exercise, row.file or "-", row.why, row.also) for row in intake_rows(found) if row.student]
    return "\n".join(lines_of_table([list(map(_cut, row, _WIDEST)) for row in (header, *body)]))


def _who(row: IntakeRow) -> str:
    return f"{row.student} ({row.name})" if row.name and row.name != row.student else row.student


def _cut(cell: str, widest: int) -> str:
    return cell if len(cell) <= widest else f"{cell[: widest - 1]}…"
