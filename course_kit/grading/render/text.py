"""A report for a terminal: readable at 80 columns, in any colour or none, and by a screen reader."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from course_kit.ros.graph_drawing import in_sentences
from course_kit.text.console import wrap_text

if TYPE_CHECKING:
    from course_kit.grading.model.report import CheckReport, Report

_MARKS = {"passed": "PASS", "failed": "FAIL", "skipped": "skip", "error": "ERR "}
_TAIL_LINES = 12
_POINTS = 7  # columns, `0.5/0.5`
_ONE_EXCHANGE = 2  # steps: a request and its response


def render_text(report: Report, width: int = 80) -> str:
    """The report as plain text, no line longer than `width` columns but for unbreakable words."""
    lines = [
        *_wrap(f"{report.title} ({report.exercise})", width),
        *_wrap(f"Submission: {report.submission}", width),
        "",
    ]
    for check in report.run:
        lines += check_lines(check, width, practice=report.practice)
    for why, checks in report.not_run.items():
        begin = _beginning("skipped", 0.0, sum(check.max_points for check in checks), practice=report.practice)
        lines += _wrap(f"{begin}{why}:", width, hanging=len(begin))
        for check in checks:
            lines += _wrap(f"- {check.title}", width, indent=len(begin), hanging=2)
    if report.problem:
        lines += _wrap(report.problem, width)
    if any(check.status != "passed" for check in report.checks):
        lines += _last_output("stdout", report.stdout, width) + _last_output("stderr", report.stderr, width)
    lines += ["", *_wrap(_verdict(report), width)]
    if report.isolation:
        lines += _wrap(f"Isolation of your program: {report.isolation}.", width, hanging=2)
    return "\n".join(lines) + "\n"


def _verdict(report: Report) -> str:
    if report.status == "unreadable":
        return "Not graded: the submission could not be read."
    if report.status == "error":
        return "Not graded, and that is not your fault. Grade again; if it happens again, please report it."
    return f"{report.verdict[:1].upper()}{report.verdict[1:]}. ({report.duration_s:.1f} s)"


def check_lines(check: CheckReport, width: int, *, practice: bool = False) -> list[str]:
    """One check's part of `render_text`; that of a drill has no points."""
    begin = _beginning(check.status, check.points, check.max_points, practice=practice)
    head = _wrap(f"{begin}{check.title}", width, hanging=len(begin))
    if check.status == "passed":
        return head
    if check.status == "skipped":
        return [*head, *_wrap(check.message, width, indent=len(begin))]
    rows = [("why", check.message), ("we sent", check.sent), ("expected", check.expected), ("we got", check.got)]
    rows += [*_steps(check), *_name_first_line("graph", in_sentences(check.graph) if check.graph else [])]
    named = f"{check.known.title} ({check.diagnosis})" if check.known else check.diagnosis
    rows += [("hint", check.hint or ""), ("diagnosis", named or "")]
    body = [line for name, text in rows if text for line in _wrap(f"{name:<9} {text}", width, indent=6, hanging=10)]
    return [*head, *body, ""]


def _beginning(status: str, points: float, most: float, *, practice: bool) -> str:
    return f"{_MARKS[status]}  " + ("" if practice else f"{points:g}/{most:g}".rjust(_POINTS) + "  ")


def _steps(check: CheckReport) -> list[tuple[str, str]]:
    """The exchange in numbered lines, where it is more than the one that the rows above tell."""
    steps = [step for step in check.steps if not step.text.startswith("expected: ")]
    if sum(step.kind != "note" for step in steps) <= _ONE_EXCHANGE:
        return []
    numbers = itertools.count(1)
    lines = [str(step) if step.kind == "note" else f"{next(numbers)}. {step}" for step in steps]
    return _name_first_line("exchange", lines)


def _name_first_line(name: str, lines: list[str]) -> list[tuple[str, str]]:
    return [("" if number else name, line) for number, line in enumerate(lines)]


def _last_output(name: str, text: str, width: int) -> list[str]:
    if not text.strip():
        return []
    tail = text.rstrip("\n").split("\n")[-_TAIL_LINES:]
    return [
        "",
        f"The last lines that your program printed ({name}), also in checks that passed:",
        *(line for part in tail for line in wrap_text(part, "  | ", "  | ", width=width) or ["  |"]),
    ]


def _wrap(text: str, width: int, indent: int = 0, hanging: int = 0) -> list[str]:
    """Lines of text; what would steer the terminal, out of a submission's source or messages, is made harmless."""
    return wrap_text(text, " " * indent, " " * (indent + hanging), width=width) or [""]
