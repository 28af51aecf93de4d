"""A report as HTML: a card for a notebook, or for a page. Nothing of it is fetched."""

from __future__ import annotations

import os
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
    from course_kit.ros.sequence import Arrow


def render_html(report: Report, base: Path | None = None, *, is_page: bool = False) -> str:
    """The report as HTML for a Jupyter output in a folder; or for a page by itself, without links to lessons."""
    card = render_template(
        Path(__file__).with_name("templates") / "card.html",
        report=report,
        in_points=in_points,
        most_points=max((check.max_points for check in report.checks), default=0.0),
        first_failed=next((check for check in report.run if check.status == "failed"), None),
        link=partial(_link, base=base or Path.cwd()),
        sequence_svg=sequence_svg,
        sequence_css=render_template(sequence.STYLE_SHEET),
        graph_css=render_template(graph_drawing.STYLE_SHEET),
        drawing=graph_drawing,
        is_page=is_page,
    )
    return str(card)


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
