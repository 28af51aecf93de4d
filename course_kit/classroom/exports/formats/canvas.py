"""Canvas: a file for "Import" in the gradebook.

What Canvas's importer asks for: the columns Student, ID, SIS User ID, SIS Login ID, Section in this order, then one for
each assignment, called like it with its number; a row whose first cell holds "Points Possible"; then the students. It
finds a student by ID, else by SIS ID or login, else by name; an empty grade changes nothing. A roster that is Canvas's
own gradebook says how the assignments are called, so that grades land in them; else Canvas asks which one is meant.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports.results import by_student, name_of, platform_of, score
from course_kit.classroom.exports.texts import Identifier, csv_text
from course_kit.classroom.intake.roster_columns import plain

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.grading.exercise import Exercise

FILE = "exports/canvas.csv"
HEADER = ("Student", "ID", "SIS User ID", "SIS Login ID", "Section")
POINTS_ROW = "Points Possible"


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """The one table."""
    yield FILE, csv_text(_rows(book))


def _rows(book: Gradebook) -> Iterator[list[str | float | None]]:
    yield [*HEADER, *(_assignment_of(exercise, book.canvas_assignments) for exercise in book.exercises)]
    yield [POINTS_ROW, *[""] * (len(HEADER) - 1), *(exercise.points for exercise in book.exercises)]
    for student, records in by_student(book).items():
        if records and all(score(record) is None for record in records.values()):
            continue  # the grader itself failed, so that there is nothing to import
        user = platform_of(records, "canvas_user") or (student if book.layout == "canvas" and student.isdigit() else "")
        name = name_of(records, book.names.get(student, student))
        if POINTS_ROW in name:  # a student of this name would be taken for the row of points
            name = name.replace(POINTS_ROW, POINTS_ROW.replace(" ", "\u00a0"))
        # Canvas finds the student by ID or login, which have to stand there exactly; the name is for people then.
        sis_id = platform_of(records, "sid") if book.canvas_assignments else ""
        login = (platform_of(records, "login") if book.canvas_assignments else "") or ("" if user else student)
        identifiers = (Identifier(user), Identifier(sis_id), Identifier(login))
        yield [name, *identifiers, "", *(score(records.get(one.id)) for one in book.exercises)]


def _assignment_of(exercise: Exercise, assignments: Sequence[str]) -> str:
    """The assignment that is called like an exercise, or like it among other words; else the exercise's title."""
    wanted = {plain(exercise.title), plain(exercise.id)}
    words = {one: plain(one.rpartition(" (")[0]) for one in assignments}
    same = [one for one, called in words.items() if called in wanted]
    alike = [one for one, called in words.items() if any(f" {each} " in f" {called} " for each in wanted)]
    found = same or alike
    return found[0] if len(found) == 1 else exercise.title
