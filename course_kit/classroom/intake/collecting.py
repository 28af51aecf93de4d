"""Finds the submissions in what an instructor has downloaded; whatever is not one is listed, never dropped.

An entry that is broken, or named like nothing else, is its own problem: everybody else's submissions are found. The
table of an intake says which file was chosen for whom, why, and what else was there; every file is in it once.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.exports.texts import csv_text, lines_of_table
from course_kit.classroom.intake import layouts, sources
from course_kit.classroom.intake.choosing import Chooser
from course_kit.classroom.intake.recognition import AUTO
from course_kit.classroom.intake.roster_matching import match_roster
from course_kit.classroom.records import Entry
from course_kit.environment import write_atomically
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.classroom.intake.roster import Roster
    from course_kit.classroom.intake.roster_matching import RosterFit
    from course_kit.grading.model.exercise import Exercise

FILE = "intake.csv"
HEADER = ("student", "name", "exercise", "file", "why", "also handed in", "late", "look at it")
_NOTHING = "nothing was handed in for it"
_WIDEST = (28, 24, 60, 90, 60)  # columns of the text


@dataclass(frozen=True)
class Intake:
    """What was handed in."""

    root: Path  # the folder the entries' sources are relative to
    layout: str  # the name of the layout that was recognised
    entries: tuple[Entry, ...]  # the submissions, by student and exercise
    left: tuple[tuple[str, str], ...]  # path and reason of every file that is none
    missing: tuple[tuple[str, str], ...]  # student and exercise of whoever handed in something else only
    # student and reason of those whose entry does not fit the layout; they are graded like everybody
    odd: tuple[tuple[str, str], ...] = ()
    # student and reason of those who handed in something and have no submission at all, or have one that cannot be had
    dropped: tuple[tuple[str, str], ...] = ()
    # who has no submission at all, in entries without exercise and source: those who handed in something else only, and
    # those on the roster who handed in nothing
    others: tuple[Entry, ...] = ()
    roster: RosterFit | None = None  # how the roster fits, when there is one


def collect_submissions(  # noqa: PLR0913, PLR0917 - what is collected, for what, and how
    source: Path | Sequence[Path],
    exercises: Sequence[Exercise],
    workspace: Path,
    layout: str = AUTO,
    reader: Reader | None = None,
    roster: Roster | None = None,
) -> Intake:
    """Find the submissions."""
    paths = [source] if isinstance(source, Path) else list(source)
    with ExitStack() as stack:
        opened = sources.open_all(paths, workspace, exercises, layout, stack)
        if not opened.units and not opened.left:
            raise GradingError(f"No files to grade in {', '.join(map(str, paths))}. Check the name.")
        chooser = Chooser(opened, exercises, stack.enter_context(reader or Reader()))
        for student, units in layouts.group_by_student(opened.units, [exercise.id for exercise in exercises]).items():
            chooser.take(student, units)
    found = Intake(
        opened.root,
        opened.layout,
        entries=tuple(chooser.entries),
        left=tuple(sorted([*opened.left, *chooser.left])),
        missing=tuple(chooser.missing),
        odd=tuple(chooser.odd),
        dropped=(*chooser.dropped, *opened.lost),
        others=tuple(chooser.others),
    )
    return found if roster is None else _with_roster(found, roster, exercises, chooser.empty)


def _with_roster(found: Intake, roster: Roster, exercises: Sequence[Exercise], empty: set[str]) -> Intake:
    """Give everybody the name and the identifiers of the class list; whoever is absent has handed in nothing."""
    entries = [*found.entries, *found.others]
    matched, fit = match_roster(roster, entries, found.layout, empty, assignments=len(exercises))
    submissions = tuple(entry for entry in matched if entry.exercise)
    had = {(entry.student, entry.exercise) for entry in submissions}
    with_entry = {student for student, _ in had}
    others = {entry.student: entry for entry in matched if not entry.exercise and entry.student not in with_entry}
    others.update((entry.student, entry) for entry in fit.absent if entry.student not in others)
    everybody = [*sorted(with_entry), *others]
    missing = tuple(
        (student, exercise.id) for student in everybody for exercise in exercises if (student, exercise.id) not in had
    )
    return replace(found, entries=submissions, missing=missing, others=tuple(others.values()), roster=fit)


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
