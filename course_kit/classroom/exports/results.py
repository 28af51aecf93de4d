"""A record in the words that several formats share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.classroom.exports.texts import number
from course_kit.text.console import in_points

if TYPE_CHECKING:
    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

MISSING = "missing"
STATES = {
    "passed": "passed",
    "failed": "not passed",
    "skipped": "not run, because an earlier check did not pass",
    "error": "could not be run: an error of the grader, not yours",
}


def score(record: Record | None) -> float | None:
    """The points; None where the grader itself failed, for that is no zero, and where nothing was handed in."""
    return record.score if record is not None and record.has_grade else None


def total(records: dict[str, Record]) -> float | None:
    """A student's points together; None where one of the scores is still to come."""
    scores = [score(record) for record in records.values()]
    return None if None in scores else sum(one or 0.0 for one in scores)


def by_student(book: Gradebook) -> dict[str, dict[str, Record]]:
    """Each student's records by exercise, students sorted."""
    table: dict[str, dict[str, Record]] = {student: {} for student in book.students}
    for record in book.records:
        table[record.entry.student][record.entry.exercise] = record
    return table


def name_of(records: dict[str, Record], otherwise: str = "") -> str:
    """A student's own name, where one of the records tells it."""
    return next((record.entry.name for record in records.values() if record.entry.name), otherwise)


def platform_of(records: dict[str, Record], key: str) -> str:
    """What a platform calls a student, see `Entry.platform`; empty when it is not known."""
    return next((found for record in records.values() if (found := record.entry.platform.get(key))), "")


def headline(record: Record) -> str:
    """The result in one sentence."""
    if not record.has_grade:
        return "Not graded: the grader itself failed. Your work is not the cause, and it will be graded again."
    points = f"{number(record.score)} of {in_points(record.max_score)}"
    if record.status == "unreadable" and record.adjustment.override is None:
        return f"{points}: the submission could not be read."
    if record.status == "crashed" and record.adjustment.override is None:
        return f"{points}: not passed yet, because the program ended before it could be checked."
    return f"{points}: {'passed' if record.passed else 'not passed yet'}."


def problem(record: Record) -> str:
    """Why there is no grade; empty when there is one."""
    return str(record.report["stderr"]).strip() if record.status in ("unreadable", "error") else ""


def explained(check: dict[str, Any]) -> str:
    """What a check has found, for the learner; empty when it passed."""
    if check["status"] == "passed":
        return ""
    shown = [("We sent", "sent"), ("Expected", "expected"), ("We got", "got")]
    parts = [f"{label}: {check[key]}" for label, key in shown if check[key]]
    parts += [check["message"]] if check["message"] else []
    parts += [f"Hint: {check['hint']}"] if check["hint"] else []
    return "\n".join(parts) or STATES[check["status"]]


def feedback(record: Record) -> list[str]:
    """Result and reasons, one paragraph each: for platforms that have one field for everything."""
    paragraphs = [headline(record), *record.remarks]
    paragraphs += [text] if (text := problem(record)) else []
    for check in record.report["checks"]:
        if check["status"] != "passed":
            paragraphs.append(f"{check['title']}: {check['message'] or STATES[check['status']]}")
    return paragraphs
