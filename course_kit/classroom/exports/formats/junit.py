"""JUnit XML for CI systems: a file for each exercise, in it a suite for each student, in it a test for each check."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from course_kit.classroom.exports.results import STATES, explained, problem
from course_kit.classroom.exports.texts import number, xml

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
            yield f"exports/junit/{exercise.id}.xml", _document(exercise.id, records)


def _document(exercise: str, records: Sequence[Record]) -> str:
    suites = [_checks(record) for record in records]
    counts = Counter(check["status"] for checks in suites for check in checks)
    duration = sum(float(record.report["duration_s"]) for record in records)
    body = "".join(_suite(place, *one) for place, one in enumerate(zip(records, suites, strict=True)))
    attributes = f'name="{exercise}" {_counts(counts, skipped=False)} time="{duration:.3f}"'
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuites {attributes}>\n{body}</testsuites>\n'


def _checks(record: Record) -> list[dict[str, Any]]:
    """The checks; of a submission that could not be graded one that says why."""
    checks: list[dict[str, Any]] = record.report["checks"]
    if checks:
        return checks
    nothing: dict[str, Any] = dict.fromkeys(("sent", "expected", "got", "hint"), "")
    told = {"id": "gradable", "title": "The submission can be graded", "message": problem(record)}
    return [{**nothing, **told, "status": "failed", "diagnosis": None}]


def _counts(counts: Counter[str], *, skipped: bool = True) -> str:
    text = f'tests="{counts.total()}" failures="{counts["failed"]}" errors="{counts["error"]}"'
    return f'{text} skipped="{counts["skipped"]}"' if skipped else text


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
        f'<testsuite name="{xml(name)}" id="{place}" package="{record.entry.exercise}" hostname="localhost" '
        f'{_counts(counts)} time="{float(record.report["duration_s"]):.3f}">\n'
        f"<properties>{listed}</properties>\n{cases}</testsuite>\n"
    )


def _case(record: Record, check: dict[str, Any]) -> str:
    # Students stand in the class's name, as CI systems list results by it.
    start = f'<testcase name="{xml(check["title"])}" classname="{xml(_class_name(record))}" time="0"'
    if check["status"] == "passed":
        return f"{start}/>\n"
    kind = _KINDS[check["status"]]
    message = check["message"] or STATES[check["status"]]
    attributes = f'type="{xml(check["diagnosis"] or _UNKNOWN)}" message="{xml(message)}"'
    return f"{start}><{kind} {attributes}>{xml(explained(check))}</{kind}></testcase>\n"


def _class_name(record: Record) -> str:
    """Dots part packages for Jenkins, so that a student's own are written otherwise."""
    return f"{record.entry.exercise}.{record.entry.student.replace('.', '_')}"
