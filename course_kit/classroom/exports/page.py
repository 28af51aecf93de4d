"""The class page: one HTML file with everything in it, nothing fetched, of use without JavaScript, too."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports import page_class, page_findings
from course_kit.classroom.exports.markup import many
from course_kit.classroom.exports.page_script import SCRIPT
from course_kit.classroom.exports.page_style import STYLE
from course_kit.classroom.exports.texts import html

if TYPE_CHECKING:
    from course_kit.classroom.gradebook import Gradebook

# Nothing may be loaded and nothing sent, whatever a student's text says.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src 'none'; base-uri 'none'"
_LAYOUTS = {
    "canvas": "Canvas",
    "moodle": "Moodle",
    "nbgrader": "nbgrader",
    "github": "GitHub Classroom",
    "folders": "a folder for each student",
    "files": "a file for each student",
}


def render(book: Gradebook) -> str:
    """The page of a class run."""
    titles = ", ".join(exercise.title for exercise in book.exercises)
    halves = (*page_findings.worries(book), *page_class.sections(book), *page_findings.sections(book))
    parts = [part for part in (*halves, page_class.students(book), *page_findings.absent(book)) if part.content]
    contents = "".join(f'<li><a href="#{part.name}">{part.title}</a></li>' for part in parts)
    body = "".join(part.html() for part in parts)
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"><meta name="robots" content="noindex">'
        f"<title>Class results: {html(titles)}</title><style>{STYLE}</style></head>\n<body>"
        '<a class="skip" href="#students">To the list of students</a>\n'
        f"<header><h1>Class results: {html(titles)}</h1>\n{_warning(book)}{_facts(book)}"
        f'<nav aria-label="Contents"><ul>{contents}</ul></nav></header>\n'
        f'<main>{body}<p id="told" role="status" class="skip"></p></main>\n'
        "<footer><p>Beside this page: <code>grades.csv</code>, <code>exports/</code> for learning platforms and CI, and"
        " <code>students/</code> with a report for each submission.</p></footer>"
        f"<script>{SCRIPT}</script></body></html>\n"
    )


def _warning(book: Gradebook) -> str:
    if book.complete:
        return ""
    return (
        '<p class="note"><strong>Not complete.</strong> The run was stopped before every submission had its result. '
        "Run the same command with <code>--resume</code> to go on.</p>\n"
    )


def _facts(book: Gradebook) -> str:
    tally = book.tally()
    states = ("passed", "not passed", "crashed", "unreadable")
    facts = [("students", len(book.students)), ("submissions", len(book.records))]
    facts += [(name, tally[name]) for name in states if tally[name]]
    facts += [("not graded: grader's error", tally["error"])] if tally["error"] else []
    facts += [("missing", len(book.missing))] if book.missing else []
    listed = "".join(f"<div><dt>{name}</dt><dd>{count}</dd></div>" for name, count in facts)
    layout = html(_LAYOUTS.get(book.layout, book.layout) or "unknown")
    told = f"Layout of the submissions: {layout}. Seed of the checks: {book.seed}."
    if book.left:
        told += f' <a href="#left">{many(len(book.left), "file")}</a> beside them.'
    return f'<dl class="facts">{listed}</dl>\n<p class="quiet">{told}</p>'
