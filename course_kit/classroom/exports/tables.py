"""The tables of a class run: `grades.csv` for people, and what Canvas, Moodle and nbgrader import.

- Canvas, "Import" in the gradebook, asks for the columns Student, ID, SIS User ID, SIS Login ID, Section in this order,
  then one for each assignment, called like it with its number; a row whose first cell holds "Points Possible"; then the
  students. It finds a student by ID, else by SIS ID or login, else by name; an empty grade changes nothing. A roster
  that is Canvas's own gradebook says how the assignments are called; else Canvas asks which one is meant.
- Moodle, "Upload grading worksheet" of an assignment, asks for Identifier, Grade and Last modified (grade), in English
  as the site is; the identifier is "Participant 4711" with the number that its archive has in each folder's name. An
  empty grade is passed over, and so is one whose "Last modified" is older than Moodle's own unless its box "Allow
  updating records that have been modified more recently" is ticked. Feedback comments are HTML.
- nbgrader: the columns of its `nbgrader export`, for whatever reads that file.
"""

from __future__ import annotations

from datetime import timezone
from typing import TYPE_CHECKING

from course_kit.classroom.exports import texts
from course_kit.classroom.exports.texts import Identifier
from course_kit.classroom.intake.roster import plain_text
from course_kit.classroom.records import outcome_of
from course_kit.text.sanitize import escape_html

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from datetime import datetime

    from course_kit.classroom.records import Gradebook, GradeRecord
    from course_kit.grading.model.exercise import Exercise

    Row = Sequence[str | float | None]

GRADES, CANVAS, MOODLE, NBGRADER = "grades.csv", "exports/canvas.csv", "exports/moodle_{}.csv", "exports/nbgrader.csv"
POINTS_ROW = "Points Possible"
_CANVAS_HEADER = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
_MOODLE_HEADER = (
    *("Identifier", "Full name", "Status", "Grade", "Maximum Grade", "Last modified (grade)", "Feedback comments"),
)
_MOODLE_NUMBER = "moodle_participant"
_NBGRADER_HEADER = (
    *("assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email", "raw_score"),
    *("late_submission_penalty", "score", "max_score"),
)


def export_tables(book: Gradebook) -> Iterator[tuple[str, str]]:
    """Path, relative to the output folder, and text of each table."""
    yield GRADES, texts.csv_text(_grades(book), mark=True)
    yield CANVAS, texts.csv_text(_canvas(book))
    yield NBGRADER, texts.csv_text(_nbgrader(book))
    for exercise in book.exercises:  # Moodle knows its participants alone
        records = [record for record in book.graded_records(exercise.id) if record.entry.platform.get(_MOODLE_NUMBER)]
        if records:
            yield MOODLE.format(exercise.id), texts.csv_text(_moodle(records))


def _grades(book: Gradebook) -> Iterator[Row]:
    """A score is empty where the grader failed or nothing was handed in, and the status says which."""
    header: list[str | float | None] = ["student", "name"]
    for exercise in book.exercises:
        header += [f"{exercise.id} {column}" for column in ("score", "max", "status", "late", "checks", "remarks")]
    yield [*header, "total", "total max"]
    full = sum(exercise.points for exercise in book.exercises)
    for student, records in texts.group_by_student(book).items():
        row: list[str | float | None] = [student, texts.name_of(records, book.names.get(student, ""))]
        for exercise in book.exercises:
            row += _grade_cells(records.get(exercise.id), exercise.points)
        yield [*row, texts.total_score(records), full]


def _grade_cells(record: GradeRecord | None, points: float) -> Row:
    if record is None:
        return [None, points, texts.MISSING, None, None, None]
    late = "late" if record.is_late else None
    checks = None if record.status == "error" else record.graded_score
    return [
        texts.score_of(record),
        record.max_score,
        outcome_of(record),
        late,
        checks,
        " ".join(record.remarks) or None,
    ]


def _canvas(book: Gradebook) -> Iterator[Row]:
    assignments = (canvas_assignment(exercise, book.canvas_assignments) for exercise in book.exercises)
    titles = [exercise.title for exercise in book.exercises]
    yield [*_CANVAS_HEADER, *(found or title for found, title in zip(assignments, titles, strict=True))]
    yield [POINTS_ROW, *[""] * (len(_CANVAS_HEADER) - 1), *(exercise.points for exercise in book.exercises)]
    for student, records in texts.group_by_student(book).items():
        if records and all(texts.score_of(record) is None for record in records.values()):
            continue  # the grader itself failed, so that there is nothing to import
        user = texts.platform_of(records, "canvas_user") or (
            student if book.layout == "canvas" and student.isdigit() else ""
        )
        name = texts.name_of(records, book.names.get(student, student))
        if POINTS_ROW in name:  # a student of this name would be taken for the row of points
            name = name.replace(POINTS_ROW, POINTS_ROW.replace(" ", "\u00a0"))
        # Canvas finds the student by ID or login, which have to stand there exactly; the name is for people then.
        sis_id = texts.platform_of(records, "sid") if book.canvas_assignments else ""
        login = (texts.platform_of(records, "login") if book.canvas_assignments else "") or ("" if user else student)
        identifiers = (Identifier(user), Identifier(sis_id), Identifier(login))
        yield [name, *identifiers, "", *(texts.score_of(records.get(exercise.id)) for exercise in book.exercises)]


def canvas_assignment(exercise: Exercise, assignments: Sequence[str]) -> str:
    """The assignment that is called like an exercise, or like it among other words; empty when none or several are."""
    wanted = {plain_text(exercise.title), plain_text(exercise.id)}
    words = {title: plain_text(title.rpartition(" (")[0]) for title in assignments}
    same = [title for title, called in words.items() if called in wanted]
    alike = [title for title, called in words.items() if any(f" {each} " in f" {called} " for each in wanted)]
    found = same or alike
    return found[0] if len(found) == 1 else ""


def _moodle(records: Sequence[GradeRecord]) -> Iterator[Row]:
    yield _MOODLE_HEADER
    for record in records:
        comments = "<br>".join(
            escape_html(paragraph).replace("\n", "<br>") for paragraph in texts.feedback_paragraphs(record)
        )
        identifier = f"Participant {record.entry.platform[_MOODLE_NUMBER]}"
        # Moodle finds the participant by the identifier; the name is for people, and may get an apostrophe.
        status = "Submitted for grading - Graded"
        yield [identifier, record.entry.name, status, record.score, record.max_score, "", comments]


def _nbgrader(book: Gradebook) -> Iterator[Row]:
    """As nbgrader does it, a row for each assignment and student, and 0 for what is missing."""
    yield _NBGRADER_HEADER
    students = texts.group_by_student(book)
    for exercise in book.exercises:
        for student, records in students.items():
            if exercise.id in records and texts.score_of(records[exercise.id]) is None:
                continue
            # The assignment's name, which nbgrader's folders tell; with several exercises theirs, to keep them apart.
            known = texts.platform_of(records, "nbgrader_assignment") if len(book.exercises) == 1 else ""
            yield [known or exercise.id, *_nbgrader_cells(exercise, student, records)]


def _nbgrader_cells(exercise: Exercise, student: str, records: dict[str, GradeRecord]) -> Row:
    record = records.get(exercise.id)
    points = 0.0 if record is None else texts.score_of(record)
    raw = 0.0 if record is None else record.graded_score
    penalty = 0.0 if record is None else record.adjustment.penalty
    due, submitted = ("", "") if record is None else (_utc(record.adjustment.due), _utc(record.adjustment.submitted))
    last, _, first = texts.name_of(records).partition(",")  # nobody can tell which part of "Li Na" is which
    # Whatever reads the file finds a student by the identifier, which has to stand there exactly.
    who = [Identifier(student), last.strip(), first.strip(), ""]
    return [due, submitted, *who, raw, penalty, points, exercise.points]


def _utc(moment: datetime | None) -> str:
    """As nbgrader writes it: UTC, without saying so."""
    return "" if moment is None else f"{moment.astimezone(timezone.utc):%Y-%m-%d %H:%M:%S}"
