"""A report as a compact card for a notebook: one self-contained piece of HTML, everything in it escaped.

Each check is a line with its state in words, not in colour alone; what failed opens by itself, hints behind a click
(a `details` element, which keyboards and screen readers know).
"""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_kit.grading.report import CheckReport, Report

_STATES = {
    "passed": ("✓", "passed"),
    "failed": ("✗", "not passed"),
    "skipped": ("○", "not run"),
    "error": ("!", "grader's error"),
}
_STYLE = """
.course-kit-report{font-family:var(--jp-ui-font-family,sans-serif);border:1px solid #888;border-radius:4px;
padding:.6em .9em;max-width:60em;color:var(--jp-ui-font-color1,#111);background:var(--jp-layout-color1,#fff)}
.course-kit-report h3{margin:.1em 0 .4em;font-size:1.1em}
.course-kit-report ol{list-style:none;margin:.4em 0;padding:0}
.course-kit-report li{border-left:.35em solid #888;margin:.25em 0;padding:.1em .6em}
.course-kit-report li.passed{border-left-color:#1a7f37}
.course-kit-report li.failed,.course-kit-report li.error{border-left-color:#b3261e;border-left-style:double}
.course-kit-report li.skipped{border-left-style:dotted}
.course-kit-report dl{display:grid;grid-template-columns:max-content 1fr;gap:.1em .8em;margin:.3em 0}
.course-kit-report dt{font-weight:600}
.course-kit-report dd{margin:0;overflow-wrap:anywhere}
.course-kit-report pre{white-space:pre-wrap;overflow-wrap:anywhere;max-height:14em;overflow:auto;margin:.3em 0}
.course-kit-report meter{width:12em;vertical-align:middle}
"""


def render_html(report: Report) -> str:
    """The report as HTML for a Jupyter output."""
    checks = "".join(_check(check) for check in report.checks)
    output = "".join(_output(name, text) for name, text in (("stdout", report.stdout), ("stderr", report.stderr)))
    problem = f"<p>{escape(report.problem)}</p>" if report.problem else ""
    listed = f"<ol>{checks}</ol>" if checks else ""
    return (
        f'<style>{_STYLE}</style><section class="course-kit-report" aria-label="Grade: {escape(report.title)}">'
        f"<h3>{escape(report.title)}</h3>{_score(report)}{problem}{listed}{output}</section>"
    )


def _score(report: Report) -> str:
    if report.status in ("unreadable", "error"):
        whose = "the submission could not be read" if report.status == "unreadable" else "the grader itself failed"
        return f"<p><strong>Not graded:</strong> {whose}.</p>"
    outcome = "passed" if report.passed else "not passed yet"
    points = f"{report.score:g} of {report.max_score:g} points"
    meter = f'<meter min="0" max="{report.max_score:g}" value="{report.score:g}" aria-hidden="true"></meter>'
    return f"<p><strong>{points}</strong>: {outcome} {meter}</p>"


def _check(check: CheckReport) -> str:
    sign, state = _STATES[check.status]
    head = (
        f'<span aria-hidden="true">{sign}</span> {escape(check.title)}: {state}, '
        f"{check.points:g} of {check.max_points:g}"
    )
    return f'<li class="{check.status}">{head}{_body(check)}</li>'


def _body(check: CheckReport) -> str:
    if check.status == "passed":
        return ""
    rows = (("We sent", check.sent), ("Expected", check.expected), ("We got", check.got))
    listed = "".join(f"<dt>{name}</dt><dd><code>{escape(text)}</code></dd>" for name, text in rows if text)
    if check.message:
        listed += f"<dt>Why</dt><dd>{escape(check.message)}</dd>"
    if check.diagnosis:
        listed += f"<dt>Diagnosis</dt><dd><code>{escape(check.diagnosis)}</code></dd>"
    hint = f"<details><summary>Show a hint</summary><p>{escape(check.hint)}</p></details>" if check.hint else ""
    return f"<dl>{listed}</dl>{hint}"


def _output(name: str, text: str) -> str:
    if not text.strip():
        return ""
    return f"<details><summary>Your program's {name}</summary><pre>{escape(text)}</pre></details>"
