"""Moodle: for each exercise a grading worksheet, for "Upload grading worksheet" of the assignment.

What Moodle's importer asks for: the columns Identifier, Grade and Last modified (grade), in English as the site is;
the identifier is "Participant 4711" with the number that its archive of submissions has in each folder's name. An
empty grade is passed over, and so is one whose "Last modified" is older than Moodle's own unless its box "Allow
updating records that have been modified more recently" is ticked. Feedback comments are HTML.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports.results import feedback
from course_kit.classroom.exports.texts import csv_text
from course_kit.text.sanitize import escaped

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

HEADER = (
    "Identifier",
    "Full name",
    "Status",
    "Grade",
    "Maximum Grade",
    "Last modified (grade)",
    "Feedback comments",
)
_NUMBER = "moodle_participant"


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """A worksheet for each exercise; none where nothing came from Moodle, which knows its participants alone."""
    for exercise in book.exercises:
        records = [record for record in book.graded(exercise.id) if record.entry.platform.get(_NUMBER)]
        if records:
            yield f"exports/moodle_{exercise.id}.csv", csv_text(_rows(records))


def _rows(records: Sequence[Record]) -> Iterator[Sequence[str | float | None]]:
    yield HEADER
    for record in records:
        comments = "<br>".join(escaped(paragraph).replace("\n", "<br>") for paragraph in feedback(record))
        identifier = f"Participant {record.entry.platform[_NUMBER]}"
        # Moodle finds the participant by the identifier; the name is for people, and may get an apostrophe.
        status = "Submitted for grading - Graded"
        yield [identifier, record.entry.name, status, record.score, record.max_score, "", comments]
