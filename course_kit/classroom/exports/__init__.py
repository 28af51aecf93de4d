"""Files for others: a gradebook as learning platforms and people want it.

Each module of `formats` is one format: its `files(book)` yields paths and texts. Adding a format means adding a module.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
from contextlib import suppress
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from course_kit.classroom.exports import (
    attention,
    changes,
    comparison,
    feedback,
    formats,
    lookalikes,
    page,
)
from course_kit.classroom.exports.program_texts import ProgramTexts
from course_kit.classroom.exports.results import headline
from course_kit.classroom.records import Entry, Records
from course_kit.environment import write_atomically
from course_kit.grading import engine
from course_kit.grading.render import html

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path
    from types import ModuleType

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

PAGE = "index.html"


def get_ready() -> None:
    """Load all that writing takes, while there is something else to wait for."""
    page.get_ready()
    html.get_ready()
    list(_formats())


def write_all(book: Gradebook, out: Path) -> Path:
    """Write every export into a class run's output folder; returns the class page."""
    made = dict(files(book))
    note_of_files = FilesWritten(out)
    note_of_files.begin(made)
    for name, text in made.items():
        # Whatever a power cut takes of these is made again from the records, so that none waits for the disk.
        write_atomically(out / name, text, durable=False)
    note_of_files.end(made)  # takes away those of students and grades that are gone
    _write_notices(book, out)
    feedback.write_all(book, out)
    with ProgramTexts(book) as texts:
        alike = lookalikes.find(book, texts)
        _write_comparisons(book, texts, alike, out)
    write_atomically(out / PAGE, page.render(book, alike, changes.since_last_run(book, out)))
    changes.remember(book, out)
    return out / PAGE


def _write_notices(book: Gradebook, out: Path) -> None:
    """Bring the notices on all report pages up to date; a page that says it already is not touched."""
    records = Records(out)
    for student, exercise in book.missing:  # who had a score all the same once, had a page for it
        entry = Entry(student, exercise, "")
        if not records.path(entry).exists():
            records.path(entry, ".html").unlink(missing_ok=True)
    for record in book.records:
        path = records.path(record.entry, ".html")
        before = _page(path, record, book)
        after = html.with_notice(before, headline(record), record.remarks)
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
    return html.render_page(report, record.entry.name or record.entry.student)


def _write_comparisons(book: Gradebook, texts: ProgramTexts, alike: lookalikes.LookAlikes, out: Path) -> None:
    """Write a page for each pair that looks alike, and take away those of an earlier run."""
    written = set()
    for name, text in comparison.pages(texts, alike.pairs, attention.labels(book)):
        write_atomically(out / name, text, durable=False)
        written.add(out / name)
    for old in set((out / comparison.FOLDER).glob("*.html")) - written:
        old.unlink(missing_ok=True)


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """Path, relative to the output folder, and text of every file of every format."""
    for module in _formats():
        yield from module.files(book)


def _formats() -> Iterator[ModuleType]:
    for found in sorted(pkgutil.iter_modules(formats.__path__), key=lambda one: one.name):
        yield importlib.import_module(f"{formats.__name__}.{found.name}")


_LIST = "exports/.files.json"


class FilesWritten:
    """The list of export files in an output folder."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._before = _names(out)

    def begin(self, names: Iterable[str]) -> None:
        """Note what is going to be written, beside what is there: a run may end before `end`."""
        self._note(self._before | set(names))

    def end(self, names: Iterable[str]) -> None:
        """Take away what was written once and is not among `names`."""
        for name in self._before - set(names):
            (self._out / name).unlink(missing_ok=True)
            with suppress(OSError):  # one holds more
                for folder in list(PurePosixPath(name).parents)[:-1]:  # but the output folder itself
                    (self._out / folder).rmdir()
        self._note(set(names))

    def _note(self, names: set[str]) -> None:
        write_atomically(self._out / _LIST, json.dumps(sorted(names), indent=0) + "\n", durable=False)


def _names(out: Path) -> set[str]:
    """What an earlier run has noted; nothing outside of `exports`, whatever stands in the list."""
    try:
        found = json.loads((out / _LIST).read_text(encoding="utf-8"))
        paths = [PurePosixPath(name) for name in found]
    except (OSError, ValueError, TypeError):
        return set()
    return {str(path) for path in paths if path.parts[:1] == ("exports",) and ".." not in path.parts}
