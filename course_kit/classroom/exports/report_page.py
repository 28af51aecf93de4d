"""The report of one submission as a page for its student. Nothing of it is fetched."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.render.html import render_html
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.model.report import Report
    from course_kit.grading.model.submission import Submission

_TEMPLATES = Path(__file__).with_name("templates")
# Between these a page may get a notice later on. Whatever a submission says is escaped, and cannot hold one of them.
_NOTICE_BEGINS, _NOTICE_ENDS = "<!-- notice -->", "<!-- end of notice -->"
MOST_LINES = 1500
LONGEST = 500  # characters of a line that are shown
# As `Submission.describe_line` words it; a learner's program may say the like, and then marks a line too many.
_PLACE = re.compile(r"(?:\b\w[\w.-]{0,99}\.py, )?\b(?:(?:cell \d{1,6}|In\[\d{1,6}\]), )?line \d{1,6}\b")


@dataclass(frozen=True)
class ProgramLine:
    """One line of a program."""

    number: int  # in the program, from 1
    place: str  # what messages call it, `line 12` or `cell 3, line 2`
    text: str  # the line, cut if it is very long
    checks: tuple[str, ...] = ()  # titles of the failed checks that speak of it


def mark_lines(report: Report, program: Submission) -> Sequence[ProgramLine]:
    """The program's lines, up to `MOST_LINES`; those that a failed check names are marked with its title."""
    said = [(check.title, check.told or check.message) for check in report.checks if check.status == "failed"]
    named: dict[str, list[str]] = {}
    for title, text in [*said, (report.title, report.problem)]:
        for place in dict.fromkeys(_PLACE.findall(text)):
            named.setdefault(place, []).append(title)
    found = []
    for name, file in program.files.items() or [("", program)]:
        for number, text in enumerate(file.source.rstrip("\n").split("\n"), start=1):
            place = f"{name}, {file.describe_line(number)}" if name else file.describe_line(number)
            found.append(ProgramLine(number, place, text[:LONGEST], tuple(named.get(place, ()))))
    return found[:MOST_LINES]


def render_page(report: Report, student: str, program: Submission | None = None) -> str:
    """The report for one student as an HTML document, to be opened from a folder or sent by mail."""
    from markupsafe import Markup

    page = render_template(
        _TEMPLATES / "report_page.html",
        title=report.title,
        student=student,
        card=Markup(render_html(report, Path(), is_page=True)),  # noqa: S704 - it escapes
        program=mark_lines(report, program) if program else [],
        most_lines=MOST_LINES,
    )
    return str(page)


def with_notice(page: str, score: str, sentences: Sequence[str]) -> str:
    """A page of `render_page` with a notice above the report, in the place of the one before."""
    before, begins, rest = page.partition(_NOTICE_BEGINS)
    _, ends, after = rest.partition(_NOTICE_ENDS)
    if not begins or not ends:  # not a page of ours any more
        return page
    notice = render_template(_TEMPLATES / "notice.html", score=score, sentences=sentences).strip() if sentences else ""
    return f"{before}{begins}{notice}{ends}{after}"
