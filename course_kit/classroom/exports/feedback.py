"""Feedback that learning platforms take back: for each exercise a zip with a report for each student.

- Moodle, "Upload multiple feedback files in a zip": a folder for each participant, called as in its download. It finds
  the participant by the number in second place, so that no underscore may stand in the name.
- Canvas, "Re-Upload Submissions": files that are called exactly as in its download, and are of the same kind: a report
  for a .py file is Python (comments), for a .ipynb file a notebook, and for a zip a zip.
"""

from __future__ import annotations

import io
import json
import re
import zipfile
from typing import TYPE_CHECKING

from course_kit.classroom.exports.texts import STATES, describe_problem, explain_check, format_number, result_headline
from course_kit.classroom.intake.archive import CONTENTS
from course_kit.classroom.records import RecordFolder
from course_kit.environment import write_atomically
from course_kit.text.console import in_points
from course_kit.text.sanitize import make_encodable, make_printable, one_line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from course_kit.classroom.records import Gradebook, GradeRecord

    Packer = Callable[[GradeRecord, Path], tuple[str, str | bytes] | None]

MOODLE, CANVAS = "exports/moodle_feedback_{}.zip", "exports/canvas_feedback_{}.zip"
_UNFIT = re.compile(r"[^\w .,'()-]|_")  # in the name of a folder: what Moodle parts names at, and what paths are of
_LONGEST_NAME = 80  # characters


def write_all(book: Gradebook, out: Path) -> None:
    """Write the zips of each platform that something came from, and take away those that are out of date."""
    packers: tuple[tuple[str, Packer], ...] = ((MOODLE, _for_moodle), (CANVAS, _for_canvas))
    for exercise in book.exercises:
        for name, pack in packers:
            path = out / name.format(exercise.id)
            found = (pack(record, out) for record in book.graded_records(exercise.id))
            if files := [file for file in found if file is not None]:
                write_atomically(path, _zip_texts(files), durable=False)
            else:
                path.unlink(missing_ok=True)


def _for_moodle(record: GradeRecord, out: Path) -> tuple[str, str] | None:
    participant = record.entry.platform.get("moodle_participant")
    page = RecordFolder(out).path(record.entry, ".html")
    if not participant or not page.is_file():
        return None
    name = " ".join(_UNFIT.sub(" ", record.entry.name).split())[:_LONGEST_NAME].strip(" .") or "Participant"
    folder = f"{name}_{participant}_assignsubmission_file"
    return f"{folder}/report_{record.entry.exercise}.html", page.read_text(encoding="utf-8")


def _for_canvas(record: GradeRecord, out: Path) -> tuple[str, str | bytes] | None:
    del out
    attachment = record.entry.platform.get("canvas_submission")
    parts = record.entry.source.split("/")
    found = (part.removesuffix(CONTENTS) for part in parts if attachment and f"_{attachment}_" in part)
    if (name := next(found, None)) is None:
        return None
    return make_encodable(name), _as_program(name, list(report_lines(record)))


def _as_program(name: str, told: list[str]) -> str | bytes:
    """A report as a file of the kind that its name promises."""
    if name.lower().endswith(".ipynb"):
        source = "\n".join(f"    {line}".rstrip() for line in told)  # indented, Markdown takes it as it is
        cell = {"cell_type": "markdown", "metadata": {}, "source": source}
        return json.dumps({"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 4}, indent=1) + "\n"
    if name.lower().endswith(".zip"):
        return _zip_texts([("report.txt", "\n".join(told))])
    start = "# " if name.lower().endswith(".py") else ""
    return "".join(f"{start}{line}".rstrip() + "\n" for line in told)


def report_lines(record: GradeRecord) -> Iterator[str]:
    """A report as lines of plain text."""
    yield record.title or record.entry.exercise
    yield from (one_line(text) for text in (result_headline(record), *record.remarks))
    yield from make_printable(describe_problem(record)).splitlines()
    for check in record.report["checks"]:
        yield ""
        points = f"{format_number(check['points'])} of {in_points(check['max_points'])}"
        yield f"{one_line(check['title'])}: {STATES[check['status']]}, {points}"
        yield from (f"  {line}" for line in make_printable(explain_check(check)).splitlines())


def _zip_texts(files: list[tuple[str, str | bytes]]) -> bytes:
    """A zip that is the same for the same files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, text in files:
            data = text if isinstance(text, bytes) else make_encodable(text)
            archive.writestr(zipfile.ZipInfo(name), data, zipfile.ZIP_DEFLATED)
    return stream.getvalue()
