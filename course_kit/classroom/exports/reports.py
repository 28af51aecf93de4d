"""What an instructor has made of a result, told in the student's report: lateness, penalty, override and comment.

The report is written when its submission is graded; these may change without a grading, so that they are put into the
page afterwards.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports.results import headline
from course_kit.classroom.records import Records
from course_kit.environment import write_atomically
from course_kit.grading.render.html import with_remarks

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.gradebook import Gradebook


def refresh(book: Gradebook, out: Path) -> None:
    """Bring the remarks in all reports up to date.

    Args:
        book: the class.
        out: the folder of all results.

    Raises:
        OSError: a report could not be read or written.
    """
    records = Records(out)
    for record in book.records:
        path = records.path(record.entry, ".html")
        if not path.is_file():
            continue
        before = path.read_text(encoding="utf-8")
        remarks = record.remarks
        now = with_remarks(before, [headline(record), *remarks] if remarks else [])
        if now != before:
            write_atomically(path, now, durable=False)
