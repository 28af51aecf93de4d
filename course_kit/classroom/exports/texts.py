"""Records in words and cells; text of strangers on its way into CSV and JSON arrives, and steers nothing."""

from __future__ import annotations

import csv
import io
import json
import re
from typing import TYPE_CHECKING, Any

from course_kit.text.console import in_points
from course_kit.text.sanitize import make_printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from course_kit.classroom.records import Gradebook, GradeRecord

_DIGITS = 6
# What spreadsheets take for a formula, the wide forms of East Asian keyboards included, after any blank or invisible
# character; and a tab, carriage return or line end, which some of them drop before they look.
_FORMULA = re.compile(r"[\s\x00-\x1f\u00a0\u200b-\u200f\u2060\ufeff]*[=+\-@＝＋－＠]|[\t\r\n]")  # noqa: RUF001
_NUMBER = re.compile(r"-?\d{1,15}(\.\d+)?")
# What is read as text, a name or a number at worst, whatever sign it begins with: no call, no link, no other program.
_HARMLESS = re.compile(r"[\w.@+-]*", re.ASCII)
MISSING = "missing"
STATES = {
    "passed": "passed",
    "failed": "not passed",
    "skipped": "not run, because an earlier check did not pass",
    "error": "could not be run: an error of the grader, not yours",
}


def format_number(value: float) -> str:
    """A number as people and machines read it: `8`, `7.5`, never `8.0` or `1e+06`."""
    rounded = round(value, _DIGITS)
    return str(int(rounded)) if rounded == int(rounded) else f"{rounded:.{_DIGITS}f}".rstrip("0")


class Identifier(str):
    """A cell by which a platform finds a student: with an apostrophe in front it would find nobody."""

    __slots__ = ()


def csv_cell(value: str | float | None) -> str:
    """A cell of a CSV file that no spreadsheet takes for a formula."""
    if value is None:
        return ""
    if not isinstance(value, str):
        return format_number(value)
    if isinstance(value, Identifier) and _HARMLESS.fullmatch(value):
        return value
    text = make_printable(value)
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def lines_of_table(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Rows for a terminal, their columns below one another."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()


def csv_text(rows: Iterable[Sequence[str | float | None]], *, mark: bool = False) -> str:
    r"""Rows as CSV after RFC 4180: commas, quotes where they are needed, \r\n."""
    file = io.StringIO(newline="")
    csv.writer(file).writerows([csv_cell(value) for value in row] for row in rows)
    return ("\ufeff" if mark else "") + file.getvalue()


def json_text(value: Any) -> str:
    """A JSON document of which each text is printable."""
    return json.dumps(_make_values_printable(value), indent=1, ensure_ascii=False)


def _make_values_printable(value: Any) -> Any:
    if isinstance(value, str):
        return make_printable(value)
    if isinstance(value, dict):
        return {key: _make_values_printable(item) for key, item in value.items()}
    return [_make_values_printable(item) for item in value] if isinstance(value, (list, tuple)) else value


def score_of(record: GradeRecord | None) -> float | None:
    """The points; None where the grader itself failed, for that is no zero, and where nothing was handed in."""
    return record.score if record is not None and record.has_grade else None


def total_score(records: dict[str, GradeRecord]) -> float | None:
    """A student's points together; None where one of the scores is still to come."""
    scores = [score_of(record) for record in records.values()]
    return None if None in scores else sum(score or 0.0 for score in scores)


def group_by_student(book: Gradebook) -> dict[str, dict[str, GradeRecord]]:
    """Each student's records by exercise, students sorted."""
    table: dict[str, dict[str, GradeRecord]] = {student: {} for student in book.students}
    for record in book.records:
        table[record.entry.student][record.entry.exercise] = record
    return table


def name_of(records: dict[str, GradeRecord], otherwise: str = "") -> str:
    """A student's own name, where one of the records tells it."""
    return next((record.entry.name for record in records.values() if record.entry.name), otherwise)


def platform_of(records: dict[str, GradeRecord], key: str) -> str:
    """What a platform calls a student, see `Entry.platform`; empty when it is not known."""
    return next((found for record in records.values() if (found := record.entry.platform.get(key))), "")


def result_headline(record: GradeRecord) -> str:
    """The result in one sentence."""
    if not record.has_grade:
        return "Not graded: the grader itself failed. Your work is not the cause, and it will be graded again."
    points = f"{format_number(record.score)} of {in_points(record.max_score)}"
    if record.status == "unreadable" and record.adjustment.override is None:
        return f"{points}: the submission could not be read."
    if record.status == "crashed" and record.adjustment.override is None:
        return f"{points}: not passed yet, because the program ended before it could be checked."
    return f"{points}, {'passed' if record.passed else 'not passed yet'}."


def describe_problem(record: GradeRecord) -> str:
    """Why there is no grade; empty when there is one."""
    return str(record.report["stderr"]).strip() if record.status in ("unreadable", "error") else ""


def explain_check(check: dict[str, Any]) -> str:
    """What a check has found, for the learner; empty when it passed."""
    if check["status"] == "passed":
        return ""
    rows = [("We sent", "sent"), ("Expected", "expected"), ("We got", "got")]
    parts = [f"{label}: {check[key]}" for label, key in rows if check[key]]
    parts += [check["message"]] if check["message"] else []
    parts += [f"Hint: {check['hint']}"] if check["hint"] else []
    return "\n".join(parts) or STATES[check["status"]]


def feedback_paragraphs(record: GradeRecord) -> list[str]:
    """Result and reasons, one paragraph each: for platforms that have one field for everything."""
    paragraphs = [result_headline(record), *record.remarks]
    paragraphs += [text] if (text := describe_problem(record)) else []
    for check in record.report["checks"]:
        if check["status"] != "passed":
            paragraphs.append(f"{check['title']}: {check['message'] or STATES[check['status']]}")
    return paragraphs
