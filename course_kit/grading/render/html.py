"""A report as a compact card for a notebook: one self-contained piece of HTML, everything in it escaped.

Each check is a line with its state in words and a bar: as long as the check is worth, filled when it passed, hatched
when not. What failed unfolds (`details` elements, which keyboards and screen readers know): the first by itself.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from course_kit import environment
from course_kit.grading.output import escaped
from course_kit.grading.render.card_style import STYLE
from course_kit.grading.render.sequence import sequence_svg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.diagnosis.catalogue import Diagnosis
    from course_kit.grading.report import CheckReport, Report

_STATES = {
    "passed": ("✓", "passed"),
    "failed": ("✗", "not passed"),
    "skipped": ("○", "not run"),
    "error": ("!", "grader's error"),
}
# JupyterLab would take Enter on a line that unfolds for its own command to edit the cell.
_KEYS_ARE_OURS = 'data-lm-suppress-shortcuts="true"'
_BAR_EM = 6.0  # length of the bar of the check that is worth most


def render_html(report: Report, base: Path | None = None) -> str:
    """The report as HTML for a Jupyter output.

    Args:
        report: what to show.
        base: the folder of the notebook that shows it, from which links to the lessons lead; the present one when None.
    """
    most = max((check.max_points for check in report.checks), default=0.0)
    first = next((check for check in report.checks if check.status == "failed"), None)
    checks = "".join(_check(check, most, base or Path.cwd(), unfold=check is first) for check in report.checks)
    output = "".join(_output(name, text) for name, text in (("stdout", report.stdout), ("stderr", report.stderr)))
    problem = f"<p>{escaped(report.problem)}</p>" if report.problem else ""
    listed = f'<ol class="ck-checks">{checks}</ol>' if checks else ""
    walls = f'<p class="ck-walls">Isolation: {escaped(report.isolation)}.</p>' if report.isolation else ""
    return (
        f'<style>{STYLE}</style><section class="course-kit-report" {_KEYS_ARE_OURS} '
        f'aria-label="Grade: {escaped(report.title)}">'
        f"<h3>{escaped(report.title)}</h3>{_score(report)}{problem}{listed}{output}{walls}</section>"
    )


def _score(report: Report) -> str:
    if report.status in ("unreadable", "error"):
        whose = "the submission could not be read" if report.status == "unreadable" else "the grader itself failed"
        return f"<p><strong>Not graded:</strong> {whose}.</p>"
    outcome = "passed" if report.passed else "not passed yet"
    points = f"{report.score:g} of {report.max_score:g} points"
    share = 100.0 * report.score / report.max_score if report.max_score else 0.0
    bar = f'<span class="ck-bar ck-total" aria-hidden="true"><span style="width:{share:.1f}%"></span></span>'
    return f'<p class="ck-score"><strong>{points}</strong>: {outcome} {bar}</p>'


def _check(check: CheckReport, most: float, base: Path, *, unfold: bool) -> str:
    sign, state = _STATES[check.status]
    points = f"{check.points:g} of {check.max_points:g}" if check.max_points else "worth no points"
    head = (
        f'<span class="ck-sign" aria-hidden="true">{sign}</span> '
        f'<span class="ck-title">{escaped(check.title)}<span class="ck-state">: {state}, {points}</span></span> '
        f"{_bar(check, most)}"
    )
    body = _body(check, base)
    if not body:
        return f'<li class="{check.status}"><div class="ck-head">{head}</div></li>'
    opened = " open" if unfold else ""
    return f'<li class="{check.status}"><details{opened}><summary class="ck-head">{head}</summary>{body}</details></li>'


def _bar(check: CheckReport, most: float) -> str:
    """As long as the check is worth; of a check without points only the place where it would be."""
    if not check.max_points:
        return '<span class="ck-place" aria-hidden="true"></span>'
    length, share = _BAR_EM * check.max_points / most, 100.0 * check.points / check.max_points
    return (
        f'<span class="ck-place" aria-hidden="true"><span class="ck-bar" style="width:{length:.2f}em">'
        f'<span style="width:{share:.0f}%"></span></span></span>'
    )


def _body(check: CheckReport, base: Path) -> str:
    if check.status == "passed":
        return ""
    found = check.known
    happened = check.told or check.message
    rows = [("We sent", check.sent, True), ("Expected", check.expected, True), ("We got", check.got, True)]
    rows += [("What happened" if check.status == "failed" else "Why", happened, False)]
    if found and check.told:
        rows.append(("Why that happens", found.explanation, False))
    listed = "".join(_row(name, text, code=code) for name, text, code in rows if text)
    if check.diagnosis:
        title = f"{escaped(found.title)} " if found else ""
        listed += f"<dt>Diagnosis</dt><dd>{title}<code>{escaped(check.diagnosis)}</code></dd>"
    if found and (link := _link(found, base)):
        listed += f"<dt>Read on</dt><dd>{link}</dd>"
    return f"<dl>{listed}</dl>{_exchange(check)}{_hints(_ladder(check))}"


def _row(name: str, text: str, *, code: bool) -> str:
    content = f"<code>{escaped(text)}</code>" if code else escaped(text)
    return f"<dt>{name}</dt><dd>{content}</dd>"


def _link(found: Diagnosis, base: Path) -> str:
    """A link to the lesson; JupyterLab opens it beside the notebook, at the heading."""
    lesson = environment.lesson(found.notebook, base)
    if lesson is None:
        return ""
    way = Path(os.path.relpath(lesson, base)).as_posix()
    target = f"{quote(way)}#{quote(found.section.replace(' ', '-'))}"
    return f'<a href="{escaped(target)}">{escaped(found.notebook)}: {escaped(found.section)}</a>'


def _exchange(check: CheckReport) -> str:
    if not check.steps:
        return ""
    lines = "".join(f"<li>{escaped(step.line())}</li>" for step in check.steps)
    return (
        f'<div class="ck-exchange">{sequence_svg(check.steps)}'
        f"<details><summary>The diagram in words</summary><ol>{lines}</ol></details></div>"
    )


def _ladder(check: CheckReport) -> tuple[str, ...]:
    return (check.hint, *check.more_hints) if check.hint else ()


def _hints(ladder: Sequence[str]) -> str:
    """One hint behind a click, the one after it behind a click in it."""
    if not ladder:
        return ""
    rest = _hints(ladder[1:]).replace("Show a hint", "Show the next hint", 1)
    return f'<details class="ck-hint"><summary>Show a hint</summary><p>{escaped(ladder[0])}</p>{rest}</details>'


def _output(name: str, text: str) -> str:
    if not text.strip():
        return ""
    return f"<details><summary>Your program's {name}</summary><pre>{escaped(text)}</pre></details>"
