"""JUnit XML for CI systems: a file for each exercise, in it a suite for each student, in it a test for each check.

It keeps to both schemas that people check against: that of Jenkins's xUnit plugin (junit-10.xsd), and the stricter one
of Ant's reports (JUnit.xsd), which wants the elements of a suite in order, a time and host for each suite, output last,
a type for each failure, and nothing said of all suites together.
"""

from __future__ import annotations

from collections import Counter
from datetime import timezone
from typing import TYPE_CHECKING, Any

from course_kit.classroom.exports.results import STATES, explained, problem
from course_kit.classroom.exports.texts import number, xml
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

_KINDS = {"failed": "failure", "error": "error", "skipped": "skipped"}
_UNKNOWN = "unknown"


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """One file for each exercise with a grade; what the grader itself failed for is not in it."""
    for exercise in book.exercises:
        if records := book.graded(exercise.id):
            yield f"exports/junit/{exercise.id}.xml", _document(records)


def _document(records: Sequence[Record]) -> str:
    body = "".join(_suite(place, record, _checks(record)) for place, record in enumerate(records))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuites>\n{body}</testsuites>\n'


def _checks(record: Record) -> list[dict[str, Any]]:
    """The checks; of a submission that could not be graded one that says why."""
    checks: list[dict[str, Any]] = record.report["checks"]
    if checks:
        return checks
    nothing: dict[str, Any] = dict.fromkeys(("sent", "expected", "got", "hint"), "")
    told = {"id": "gradable", "title": "The submission can be graded", "message": problem(record)}
    return [{**nothing, **told, "status": "failed", "diagnosis": None}]


def _suite(place: int, record: Record, checks: Sequence[dict[str, Any]]) -> str:
    counts = Counter(check["status"] for check in checks)
    properties = {
        "student": record.entry.student,
        "score": number(record.score),
        "max_score": number(record.max_score),
        "status": record.status,
    }
    listed = "".join(f'<property name="{name}" value="{xml(value)}"/>' for name, value in properties.items())
    cases = "".join(_case(record, check) for check in checks)
    name = f"{record.entry.name or record.entry.student}: {record.title or record.entry.exercise}"
    return (
        f'<testsuite name="{xml(one_line(name))}" id="{place}" package="{record.entry.exercise}" hostname="localhost" '
        f'timestamp="{_moment(record)}" tests="{counts.total()}" failures="{counts["failed"]}" '
        f'errors="{counts["error"]}" skipped="{counts["skipped"]}" time="{float(record.report["duration_s"]):.3f}">\n'
        f"<properties>{listed}</properties>\n{cases}<system-out/>\n<system-err/>\n</testsuite>\n"
    )


def _moment(record: Record) -> str:
    """When it was handed in, in UTC; the beginning of all times where nobody knows, as there has to be one."""
    submitted = record.adjustment.submitted
    return "1970-01-01T00:00:00" if submitted is None else f"{submitted.astimezone(timezone.utc):%Y-%m-%dT%H:%M:%S}"


def _case(record: Record, check: dict[str, Any]) -> str:
    # Students stand in the class's name, as CI systems list results by it.
    start = f'<testcase name="{xml(one_line(check["title"]))}" classname="{xml(_class_name(record))}" time="0.000"'
    if check["status"] == "passed":
        return f"{start}/>\n"
    kind = _KINDS[check["status"]]
    message = check["message"] or STATES[check["status"]]
    # What was skipped has no type in Ant's schema; what failed must have one.
    kind_of = "" if kind == "skipped" else f'type="{xml(check["diagnosis"] or _UNKNOWN)}" '
    attributes = f'{kind_of}message="{xml(message)}"'
    return f"{start}><{kind} {attributes}>{xml(explained(check))}</{kind}></testcase>\n"


def _class_name(record: Record) -> str:
    """Dots part packages for Jenkins, so that a student's own are written otherwise."""
    return one_line(f"{record.entry.exercise}.{record.entry.student.replace('.', '_')}")
