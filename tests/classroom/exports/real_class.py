"""A class of 300 as it comes: every state and accident, names that are equal or long, programs that look alike."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.classroom import exports
from course_kit.classroom.exports.report_page import render_page
from course_kit.classroom.records import Entry, RecordFolder
from course_kit.classroom.rules.adjustments import Adjustment
from course_kit.grading.model.report import CheckReport, Report
from course_kit.grading.reading import Reader, copy_file
from tests.classroom.exports import books
from tests.classroom.exports.books import ROBOT, SERVICE, check
from tests.classroom.exports.programs import ORIGINAL, class_of, disguised

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import Gradebook, GradeRecord
    from course_kit.grading.model.exercise import Exercise

STUDENTS = 300
FIRST = ("Jane", "Jörg", "Li", "Zoë", "Omar", "Ana María", "Wei", "Fatima", "Ole", "Priya", "سارة")
LAST = ("Doe", "Müller", "Na", "Okafor", "García", "Nguyen", "Hansen", "Rao", "أحمد")
CHECKS = (
    ("The service /convert_temperature is there, with its type", "name.service"),
    ("A request gets an answer", "service.no_return"),
    ("Celsius becomes Fahrenheit", "math.formula"),
    ("Fahrenheit becomes Celsius", "math.formula"),
    ("No digits are lost, whether the value is large, small or very cold", "math.integer_division"),
    ("An unknown unit is refused with a reason", "validation.no_reason"),
    ("A temperature below absolute zero is refused with a reason, absolute zero itself is not", "validation.missing"),
    ("Fifty calls, ten at a time, are all answered within 5 s, each with its own value", "service.blocks"),
)


def write(out: Path) -> Path:
    """Two runs of the class into a folder, with all reports; returns the class page of the second."""
    gradebook = _book(out / "in")
    for record in gradebook.records:
        RecordFolder(out).keep(record, render_page(_report(record), record.entry.name or record.entry.student))
    exports.write_all(replace(gradebook, records=gradebook.records[7:]), out)
    return exports.write_all(gradebook, out)


def write_a_report(out: Path) -> Path:
    """The report of a program of which a line is marked."""
    record = class_of(out, ann=ORIGINAL)[0]
    failed = CheckReport(
        *("answers", "A request gets an answer", "failed", 10.0, "21.5 °C", "70.7 °F", "no answer"),
        diagnosis="service.exception",
        message="Your callback raised KeyError: 'kelvin' in line 16: factor, shift = self.table[...].",
        hint="Which units can a request name?",
    )
    with Reader() as reader, copy_file(out / record.entry.source) as copy:
        program = reader.read(copy, SERVICE)
    report = replace(_report(record), checks=(failed,), stderr="Traceback (most recent call last):\n" * 30)
    path = out / "report.html"
    path.write_text(render_page(report, "Jane Doe", program), encoding="utf-8")
    return path


def _book(root: Path) -> Gradebook:
    chance = random.Random(3)  # noqa: S311 - an example
    students = [f"{number:06}" for number in range(STUDENTS - 8)]
    names = {student: f"{chance.choice(FIRST)} {chance.choice(LAST)}" for student in students}
    records = [_one(chance, student, of, name=names[student]) for student in students for of in (SERVICE, ROBOT)]
    records += class_of(root, ann=ORIGINAL, bob=disguised(ORIGINAL), cid=ORIGINAL + "# the same")
    records += [books.good("x" * 200, name="Maximiliane-" * 20), books.not_graded("900", name="Jane Doe")]
    absent = tuple((f"absent{number}", f"{FIRST[number]} {LAST[number]}") for number in range(3))
    return books.book(
        *records,
        exercises=(SERVICE, ROBOT),
        root=root,
        missing=tuple((student, of.id) for student, _ in absent for of in (SERVICE, ROBOT)),
        absent=absent,
        others=tuple(Entry(student, "", "", name) for student, name in absent),
        left=tuple((f"{student}/notes.txt", "it belongs to none of these exercises") for student in students[:40]),
        dropped=(("zoe", "zoe/answer.py: it is a link, and links are not followed"),),
        odd=(("yan", "its name does not follow the layout 'folders'"),),
    )


def _one(chance: random.Random, student: str, of: Exercise, name: str) -> GradeRecord:
    entry = {
        "name": name,
        "late": chance.random() < 0.04,
        "others": ["old.py: older"] if chance.random() < 0.05 else [],
        "why": "it is the newest of 2",
        "worry": "only its name was better than that of copy.py" if chance.random() < 0.01 else "",
    }
    if chance.random() < 0.04:
        return books.unreadable(student, of=of, **entry)
    skill = chance.random() ** 0.4
    checks = [
        check(
            title,
            "passed" if chance.random() < skill else "failed",
            of.points / len(CHECKS),
            title=title,
            diagnosis=code,
        )
        for title, code in CHECKS
    ]
    found = books.record(student, checks, of=of, **entry)
    if chance.random() < 0.02:
        found = replace(found, adjustment=Adjustment(pass_mark=of.pass_mark, override=8.0, comment="Shown to me."))
    return found


def _report(record: GradeRecord) -> Report:
    checks = tuple(
        CheckReport(**{name: one[name] for name in ("id", "title", "status", "points", "max_points", "message")})
        for one in record.report["checks"]
    )
    return Report(
        *(record.entry.exercise, record.title, "answer.py", record.status, record.passed),
        *(record.graded_score, record.max_score, 1.0, checks),
    )
