"""Files for others: a gradebook as learning platforms and people want it."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from course_kit.classroom.exports import (
    attention,
    autograder_results,
    changes,
    feedback,
    lookalikes,
    page,
    tables,
)
from course_kit.classroom.exports.lookalikes import ProgramTexts
from course_kit.classroom.exports.report_page import render_page, with_notice
from course_kit.classroom.exports.texts import result_headline
from course_kit.classroom.records import Entry, RecordFolder
from course_kit.environment import write_atomically
from course_kit.grading import engine

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    from course_kit.classroom.records import Gradebook, GradeRecord

PAGE = "index.html"


def write_all(book: Gradebook, out: Path) -> Path:
    """Write every export into a class run's output folder; returns the class page."""
    made = dict(export_files(book))
    for name, text in made.items():
        # Whatever a power cut takes of these is made again from the records, so that none waits for the disk.
        write_atomically(out / name, text, durable=False)
    _remove_outdated(book, made, out)
    _write_notices(book, out)
    feedback.write_all(book, out)
    with ProgramTexts(book) as texts:
        alike = lookalikes.find_lookalikes(book, texts)
        _write_comparisons(book, texts, alike, out)
    write_atomically(out / PAGE, page.render_class(book, alike, changes.since_last_run(book, out)))
    changes.remember_results(book, out)
    return out / PAGE


def _write_notices(book: Gradebook, out: Path) -> None:
    """Bring the notices on all report pages up to date; a page that says it already is not touched."""
    records = RecordFolder(out)
    for student, exercise in book.missing:  # who had a score all the same once, had a page for it
        entry = Entry(student, exercise, "")
        if not records.path(entry).exists():
            records.path(entry, ".html").unlink(missing_ok=True)
    for record in book.records:
        path = records.path(record.entry, ".html")
        before = _page(path, record, book)
        after = with_notice(before, result_headline(record), record.remarks)
        if after and (after != before or not path.exists()):
            write_atomically(path, after, durable=False)


def _page(path: Path, record: GradeRecord, book: Gradebook) -> str:
    """The page as it is; made for whoever handed in nothing and has a score."""
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError):
        if record.entry.source:
            return ""
    exercise = next(exercise for exercise in book.exercises if exercise.id == record.entry.exercise)
    report = engine.report_unreadable(exercise, "", str(record.report["stderr"]))
    return render_page(report, record.entry.name or record.entry.student)


def _write_comparisons(book: Gradebook, texts: ProgramTexts, alike: lookalikes.LookAlikes, out: Path) -> None:
    """Write a page for each pair that looks alike, and take away those of an earlier run."""
    written = set()
    for name, text in lookalikes.pair_pages(texts, alike.pairs, attention.label_students(book)):
        write_atomically(out / name, text, durable=False)
        written.add(out / name)
    for old in set((out / lookalikes.FOLDER).glob("*.html")) - written:
        old.unlink(missing_ok=True)


def export_files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """Path, relative to the output folder, and text of every file for a platform."""
    yield from tables.export_tables(book)
    yield from autograder_results.export_results(book)


def _remove_outdated(book: Gradebook, made: Collection[str], out: Path) -> None:
    """Take away the exports of students and grades that are gone."""
    worksheets = (out / tables.MOODLE.format(exercise.id) for exercise in book.exercises)
    for path in (*worksheets, *out.glob(autograder_results.GRADESCOPE.format("*", "*"))):
        if path.relative_to(out).as_posix() not in made:
            path.unlink(missing_ok=True)
            for folder in path.parents[:2]:
                with suppress(OSError):  # it holds more
                    folder.rmdir()
