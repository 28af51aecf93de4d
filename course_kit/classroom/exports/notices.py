"""What the instructor has decided, on each student's report page: written anew for each gradebook."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports.results import headline
from course_kit.classroom.records import Entry, Records
from course_kit.environment import write_atomically
from course_kit.grading import engine
from course_kit.grading.render.html import render_page, with_notice

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record


def write(book: Gradebook, out: Path) -> None:
    """Bring the notices on all report pages up to date; a page that says it already is not touched."""
    records = Records(out)
    for student, exercise in book.missing:  # who had a score all the same once, had a page for it
        entry = Entry(student, exercise, "")
        if not records.path(entry).exists():
            records.path(entry, ".html").unlink(missing_ok=True)
    for record in book.records:
        path = records.path(record.entry, ".html")
        before = _page(path, record, book)
        after = with_notice(before, headline(record), record.remarks)
        if after and (after != before or not path.exists()):
            write_atomically(path, after, durable=False)


def _page(path: Path, record: Record, book: Gradebook) -> str:
    """The page as it is; made for whoever handed in nothing and has a score."""
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError):
        if record.entry.source:
            return ""
    exercise = next(one for one in book.exercises if one.id == record.entry.exercise)
    report = engine.unreadable(exercise, "", str(record.report["stderr"]))
    return render_page(report, record.entry.name or record.entry.student)
