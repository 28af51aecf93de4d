"""Reports without names, to show to others: made anew from the results, not cut out of the named ones.

What a student is called is replaced wherever it stands. The program and what it printed are left out, as anything may
stand in them. The order is drawn anew each time, so that it tells nothing.
"""

from __future__ import annotations

import random
import re
from typing import TYPE_CHECKING, Any

from course_kit.classroom.exports.report_page import render_page
from course_kit.classroom.exports.texts import csv_text, group_by_student
from course_kit.classroom.records import outcome_of
from course_kit.environment import write_atomically
from course_kit.grading.errors import GradingError
from course_kit.grading.model.report import FIELDS, CheckReport, Report

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.classroom.records import Gradebook, GradeRecord

_BETWEEN_WORDS = re.compile(r"[\W_]+")
_SHORTEST = 3  # letters of a part of a name to look for; shorter ones are ordinary words


def write_anonymous_pages(book: Gradebook, target: Path, chance: random.Random | None = None) -> Path:
    """Write a page for each submission and a table of scores, all by pseudonym. No list tells who is who."""
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise GradingError(f"{target} already exists. Choose a new folder.")
    students = list(group_by_student(book).items())
    (chance or random.SystemRandom()).shuffle(students)
    width = len(str(len(students)))
    rows: list[list[str | float | None]] = [["student", "exercise", "score", "max", "status"]]
    for place, (student, records) in enumerate(students, start=1):
        pseudonym = f"student-{place:0{width}}"
        for record in records.values():
            path = target / pseudonym / f"{record.entry.exercise}.html"
            write_atomically(path, render_page(_report(record, student, pseudonym), pseudonym), durable=False)
            points = record.score if record.has_grade else None
            rows.append([pseudonym, record.entry.exercise, points, record.max_score, outcome_of(record)])
    write_atomically(target / "grades.csv", csv_text(rows, mark=True))
    return target


def _report(record: GradeRecord, student: str, pseudonym: str) -> Report:
    """The report as far as it is stored, without what tells whose it is."""
    names = _names(record, student)

    def replace_names(value: Any) -> Any:
        return names.sub(pseudonym, value) if isinstance(value, str) and names.pattern else value

    report: Mapping[str, Any] = record.report
    checks = tuple(
        CheckReport(**{name: replace_names(check[name]) if name in FIELDS[5:] else check[name] for name in FIELDS})
        for check in report["checks"]
    )
    problem = replace_names(report["stderr"]) if record.status in ("unreadable", "error") else ""
    return Report(
        exercise=record.entry.exercise,
        title=record.title or record.entry.exercise,
        submission=pseudonym,
        status=record.status,
        passed=record.passed,
        score=record.score,
        max_score=record.max_score,
        duration_s=float(report["duration_s"]),
        checks=checks,
        problem=problem,
    )


def _names(record: GradeRecord, student: str) -> re.Pattern[str]:
    """Everything by which a student may be called: identifiers, the name and its parts, the file and its folders."""
    entry = record.entry
    whole = {student, entry.name, entry.source, *entry.source.split("/"), *entry.platform.values()}
    parts = {part for text in (student, entry.name) for part in _BETWEEN_WORDS.split(text)}
    wanted = {name for name in whole if name} | {part for part in parts if len(part) >= _SHORTEST}
    longest_first = sorted(wanted, key=lambda name: (-len(name), name))
    return re.compile("|".join(rf"(?<!\w){re.escape(name)}(?!\w)" for name in longest_first), re.IGNORECASE)
