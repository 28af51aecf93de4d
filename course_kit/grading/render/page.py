"""A report as a web page of its own, to be opened from a folder or sent by mail; nothing of it is fetched."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.output import escaped
from course_kit.grading.render.html import render_html

if TYPE_CHECKING:
    from course_kit.grading.report import Report

STYLE = """
:root{color-scheme:light dark}
body{font:16px/1.45 system-ui,sans-serif;max-width:60em;margin:1.5em auto;padding:0 1em}
@media print{details{display:block}}
"""


def render_page(report: Report, student: str) -> str:
    """The report for one student as a self-contained HTML document.

    Args:
        report: the report.
        student: whose it is, for the heading.
    """
    title = escaped(f"{report.title}: {student}")
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{STYLE}</style></head>'
        f"<body><main><h1>{escaped(student)}</h1>{render_html(report)}</main></body></html>\n"
    )
