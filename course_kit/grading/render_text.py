"""A report for a terminal: readable at 80 columns, in any colour or none, and by a screen reader."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_kit.grading.report import CheckReport, Report

_MARKS = {"passed": "PASS", "failed": "FAIL", "skipped": "skip", "error": "ERR "}
_TAIL_LINES = 12


def render_text(report: Report, width: int = 80) -> str:
    """The report as plain text, no line longer than `width` columns but for unbreakable words."""
    lines = [
        *_wrap(f"{report.title} ({report.exercise})", width),
        *_wrap(f"Submission: {report.submission}", width),
        "",
    ]
    for check in report.checks:
        lines += _check_lines(check, width)
    if report.problem:
        lines += _wrap(report.problem, width)
    if any(check.status != "passed" for check in report.checks):
        lines += _last_output("stdout", report.stdout, width) + _last_output("stderr", report.stderr, width)
    lines += ["", *_wrap(_verdict(report), width)]
    return "\n".join(lines) + "\n"


def _verdict(report: Report) -> str:
    if report.status == "unreadable":
        return "Not graded: the submission could not be read."
    if report.status == "error":
        return "Not graded: the grader itself failed. That is not your fault; please report it."
    outcome = "passed" if report.passed else "not passed yet"
    return f"{report.score:g} of {report.max_score:g} points: {outcome}. ({report.duration_s:.1f} s)"


def _check_lines(check: CheckReport, width: int) -> list[str]:
    points = f"{check.points:g}/{check.max_points:g}"
    head = _wrap(f"{_MARKS[check.status]}  {points:>7}  {check.title}", width, hanging=15)
    if check.status == "passed":
        return head
    if check.status == "skipped":
        return [*head, *_wrap(check.message, width, indent=15)]
    body = []
    for name, text in (("we sent", check.sent), ("expected", check.expected), ("we got", check.got)):
        if text:
            body += _wrap(f"{name:<9} {text}", width, indent=6, hanging=10)
    if check.message:
        body += _wrap(f"{'why':<9} {check.message}", width, indent=6, hanging=10)
    if check.diagnosis:
        body += _wrap(f"{'diagnosis':<9} {check.diagnosis}", width, indent=6, hanging=10)
    if check.hint:
        body += _wrap(f"{'hint':<9} {check.hint}", width, indent=6, hanging=10)
    return [*head, *body, ""]


def _last_output(name: str, text: str, width: int) -> list[str]:
    if not text.strip():
        return []
    tail = text.rstrip("\n").split("\n")[-_TAIL_LINES:]
    return ["", f"The end of your program's {name}:", *(line for part in tail for line in _cut(f"  | {part}", width))]


def _cut(line: str, width: int) -> list[str]:
    return [line[start : start + width] for start in range(0, len(line), width)] or [line]


def _wrap(text: str, width: int, indent: int = 0, hanging: int = 0) -> list[str]:
    return textwrap.wrap(
        text,
        width,
        initial_indent=" " * indent,
        subsequent_indent=" " * (indent + hanging),
        break_on_hyphens=False,
    ) or [""]
