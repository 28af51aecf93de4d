"""A report as HTML: as a card for a notebook, and as its own page. Nothing of either is fetched."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from course_kit import environment
from course_kit.grading.checks.evidence import GRADER, NODE
from course_kit.ros import graph_drawing, sequence
from course_kit.text.console import in_points
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.model.catalogue import Diagnosis
    from course_kit.grading.model.report import Report
    from course_kit.grading.model.submission import Submission
    from course_kit.ros.sequence import Arrow

_TEMPLATES = Path(__file__).with_name("templates")
# Between these a page may get a notice later on. Whatever a submission says is escaped, and cannot hold one of them.
_NOTICE_BEGINS, _NOTICE_ENDS = "<!-- notice -->", "<!-- end of notice -->"
MOST_LINES = 1500
LONGEST = 500  # characters of a line that are shown
# As `Submission.describe_line` words it; a learner's program may say the like, and then marks a line too many.
_PLACE = re.compile(r"(?:\b\w[\w.-]{0,99}\.py, )?\b(?:cell \d{1,6}, )?line \d{1,6}\b")


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


def render_html(report: Report, base: Path | None = None) -> str:
    """The report as HTML for a Jupyter output."""
    return str(render_template(_TEMPLATES / "card.html", **_values(report, base or Path.cwd())))


def render_page(report: Report, student: str, program: Submission | None = None) -> str:
    """The report for one student as an HTML document, to be opened from a folder or sent by mail."""
    values = {
        **_values(report, Path()),
        "link": lambda _: "",
        "is_page": True,
        "student": student,
        "program": mark_lines(report, program) if program else [],
        "most_lines": MOST_LINES,
    }
    return str(render_template(_TEMPLATES / "page.html", **values))


def with_notice(page: str, score: str, sentences: Sequence[str]) -> str:
    """A page of `render_page` with a notice above the report, in the place of the one before."""
    before, begins, rest = page.partition(_NOTICE_BEGINS)
    _, ends, after = rest.partition(_NOTICE_ENDS)
    if not begins or not ends:  # not a page of ours any more
        return page
    notice = render_template(_TEMPLATES / "notice.html", score=score, sentences=sentences).strip() if sentences else ""
    return f"{before}{begins}{notice}{ends}{after}"


def _values(report: Report, base: Path) -> dict[str, object]:
    return {
        "report": report,
        "in_points": in_points,
        "most_points": max((check.max_points for check in report.checks), default=0.0),
        "first_failed": next((check for check in report.run if check.status == "failed"), None),
        "link": partial(_link, base=base),
        "sequence_svg": sequence_svg,
        "sequence_css": render_template(sequence.STYLE_SHEET),
        "graph_css": render_template(graph_drawing.STYLE_SHEET),
        "drawing": graph_drawing,
        "is_page": False,
    }


def _link(found: Diagnosis, base: Path) -> str:
    """Where the lesson lies, empty where it does not; JupyterLab opens it beside the notebook, at the heading."""
    lesson = environment.paths.lesson_path(found.notebook, base)
    if lesson is None:
        return ""
    way = Path(os.path.relpath(lesson, base)).as_posix()
    return f"{quote(way)}#{quote(found.section.replace(' ', '-'))}"


def sequence_svg(steps: Sequence[Arrow]) -> str:
    """The diagram as an `svg` element, which templates take as it is; empty without steps."""
    ends = dict.fromkeys([GRADER, *(end for step in steps for end in (step.sender, step.receiver))])
    names = {end: end for end in (ends if len(ends) > 1 else (GRADER, NODE))}
    count = sum(step.kind != "note" for step in steps)
    failed = " The last one failed." if any(step.kind == "failure" for step in steps) else ""
    shown = f"Sequence diagram of {count} step{'' if count == 1 else 's'} between the {' and '.join(names)}.{failed}"
    return sequence.sequence_svg([(step, step.text) for step in steps], names, f"{shown} The list below says the same.")
