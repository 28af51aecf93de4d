"""Gradescope: for each submission the `results.json` that an autograder there leaves behind."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from course_kit.grading.classroom.records import safe_name
from course_kit.grading.exports.results import explained, headline, problem, score
from course_kit.grading.exports.texts import whole

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.classroom.gradebook import Gradebook
    from course_kit.grading.classroom.records import Record


def files(book: Gradebook) -> Iterator[tuple[str, str]]:
    """One file for each submission."""
    for record in book.records:
        folder = f"exports/gradescope/{safe_name(record.entry.student)}/{record.entry.exercise}"
        yield f"{folder}/results.json", whole(json.dumps(results(record), indent=1, ensure_ascii=False)) + "\n"


def results(record: Record) -> dict[str, Any]:
    """The result as Gradescope's specification has it.

    Without a score of its own, where the grader failed, Gradescope shows the text and asks a person to grade.
    """
    graded = score(record)
    output = "\n\n".join(filter(None, (headline(record), problem(record))))
    return {
        **({} if graded is None else {"score": graded}),
        "execution_time": record.report["duration_s"],
        "output": output,
        "output_format": "text",
        "test_output_format": "text",
        "test_name_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "extra_data": {"exercise": record.entry.exercise, "student": record.entry.student, "seed": record.seed},
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
