"""Gradescope: for each submission the `results.json` that an autograder there leaves behind."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.classroom.exports.results import explained, headline, problem
from course_kit.classroom.exports.texts import json_text
from course_kit.classroom.records import safe_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """One file for each grade; where the grader itself failed there is none."""
    for record in book.graded():
        folder = f"exports/gradescope/{safe_name(record.entry.student)}/{record.entry.exercise}"
        yield f"{folder}/results.json", json_text(results(record)) + "\n"


def results(record: Record) -> dict[str, Any]:
    """The result as Gradescope's specification has it."""
    output = "\n\n".join(filter(None, (headline(record), *record.remarks, problem(record))))
    whose = {"student": record.entry.student} if record.entry.student else {}  # its own autograder need not know
    return {
        "score": record.score,
        "execution_time": record.report["duration_s"],
        "output": output,
        "output_format": "text",
        "test_output_format": "text",
        "test_name_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "extra_data": {"exercise": record.entry.exercise, **whose, "seed": record.seed},
        "tests": [_test(number, check) for number, check in enumerate(record.report["checks"], start=1)],
    }


def _test(number: int, check: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": check["title"],
        "number": str(number),
        "score": check["points"],
        "max_score": check["max_points"],
        "status": "passed" if check["status"] == "passed" else "failed",
        "output": explained(check),
        "tags": [check["id"], *([check["diagnosis"]] if check["diagnosis"] else [])],
        "visibility": "visible",
    }
