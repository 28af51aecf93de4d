"""GitHub Classroom: the result that a grader step hands to the autograding reporter.

Two files for each submission: the JSON, and the line for `$GITHUB_OUTPUT` with the same in base64, which the reporter
then finds in its environment. It adds up the tests' scores, and fails the run when the status is fail or error.
"""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

from course_kit.classroom.exports.results import explained, problem
from course_kit.classroom.exports.texts import json_text
from course_kit.classroom.records import safe_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

VERSION = 1
_STATES = {"passed": "pass", "failed": "fail", "skipped": "fail", "error": "error"}


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """Two files for each grade; where the grader itself failed there are none."""
    for record in book.graded():
        start = f"exports/github_classroom/{safe_name(record.entry.student)}/{record.entry.exercise}"
        text = json_text(result(record))
        yield f"{start}.json", text + "\n"
        yield f"{start}.output", f"result={base64.b64encode(text.encode()).decode()}\n"


def result(record: Record) -> dict[str, Any]:
    """The result as GitHub's graders have it."""
    tests = [_test(check) for check in record.report["checks"]]
    if not tests:  # unreadable: the reporter shows tests, so that the reason has to be one
        tests = [{"name": "The submission can be graded", "status": "fail", "score": 0.0, "message": problem(record)}]
    if record.score != record.graded_score:  # the reporter adds up the tests, so that the difference has to be one
        difference = record.score - record.graded_score
        tests.append({"name": "Adjusted", "status": "pass", "score": difference, "message": " ".join(record.remarks)})
    status = "pass" if record.passed else "fail"
    return {"version": VERSION, "status": status, "max_score": record.max_score, "tests": tests}


def _test(check: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": check["title"],
        "status": _STATES[check["status"]],
        "score": check["points"],
        "message": explained(check) or None,
        "test_code": check["id"],
        "filename": "",
        "line_no": 0,
    }
