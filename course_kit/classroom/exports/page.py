"""The class page: one HTML file with everything in it, nothing fetched, of use without JavaScript, too.

What it says of a class is put together here, and `templates` write it down, each section one.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from statistics import mean, median
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from course_kit.classroom.exports import attention, comparison, counts, lookalikes
from course_kit.classroom.exports.results import by_student, name_of, problem, score, total
from course_kit.classroom.exports.texts import number
from course_kit.classroom.gradebook import outcome
from course_kit.classroom.records import STUDENTS, safe_name
from course_kit.grading.diagnosis import catalogue
from course_kit.text.templates import load
from course_kit.text.templates import render as fill_in

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.classroom.exports.changes import ResultChange
    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record
    from course_kit.grading.exercise import Exercise

_TEMPLATES = Path(__file__).with_name("templates")
_SECTIONS = {  # of the page, in its order: template and title; what has nothing to say is left out
    "attention": "Needs your attention",
    "students": "Students",
    "scores": "Scores",
    "checks": "Checks",
    "diagnoses": "Diagnoses",
    "alike": "Look-alikes",
    "extremes": "Slowest and largest",
    "left": "Other files in the folder",
}
_LAYOUTS = {
    "canvas": "Canvas",
    "moodle": "Moodle",
    "gradescope": "Gradescope",
    "nbgrader": "nbgrader",
    "github": "GitHub Classroom",
    "folders": "a folder for each student",
    "files": "a file for each student",
}
_MOST_LISTED = 10  # of the slowest and of the largest


@dataclass(frozen=True)
class Figure:
    """The scores of one exercise; `average` and `middle` are None where nobody has one."""

    exercise: Exercise
    bars: Sequence[counts.Bar]
    submissions: int
    passed: int
    average: float | None
    middle: float | None


@dataclass(frozen=True)
class HeatMap:
    """How often which diagnosis came up: for each code a row of counts, one for each column, and whose it is."""

    caption: str
    columns: Sequence[str]
    rows: dict[str, list[int]]
    having: dict[str, list[Record]]


def get_ready() -> None:
    """Load the templates before there is a class to show."""
    load(_TEMPLATES)


def render(book: Gradebook, alike: lookalikes.LookAlikes | None = None, changes: Sequence[ResultChange] = ()) -> str:
    """The page of a class run."""
    values = _values(book, alike, changes)
    contents = {name: fill_in(_TEMPLATES / f"{name}.html", **values).strip() for name in _SECTIONS}
    sections = [(name, title, contents[name]) for name, title in _SECTIONS.items() if contents[name]]
    return str(fill_in(_TEMPLATES / "class_page.html", sections=sections, **values))


def report_link(record: Record) -> str:
    """Where a submission's report lies, seen from the class page."""
    return quote(f"{STUDENTS}/{safe_name(record.entry.student)}/{record.entry.exercise}.html")


def _values(book: Gradebook, alike: lookalikes.LookAlikes | None, changes: Sequence[ResultChange]) -> dict[str, Any]:
    """What the templates name: the class, what was found out about it, and the functions that put it into words."""
    timed = [record for record in book.records if not record.same_as and record.report["duration_s"]]
    called = attention.labels(book)
    if alike is None and book.records:
        alike = lookalikes.find(book)
    # The pairs themselves are what the groups hold.
    comparable = alike.pairs[: comparison.MOST_PAIRS] if alike and book.root else []
    comparison_links = {id(pair): comparison.link(place) for place, pair in enumerate(comparable)}
    return {
        "book": book,
        "called": called,
        "absent": dict(book.absent),
        "groups": attention.groups(book, called, problem),
        "changes": changes,
        "facts": list(_facts(book)),
        "layout": _LAYOUTS.get(book.layout, book.layout) or "unknown",
        "figures": [_figure(one, records) for one in book.exercises if (records := book.graded(one.id))],
        "checks": [(one, found) for one in book.exercises if (found := counts.checks(book.of(one.id)))],
        "heat_maps": [one for one in _heat_maps(book) if one.rows],
        "diagnoses": catalogue.catalogue(),
        "alike": alike,
        "comparison_link": lambda pair: comparison_links.get(id(pair)),
        "threshold": lookalikes.THRESHOLD,
        "slowest": sorted(timed, key=lambda one: -float(one.report["duration_s"]))[:_MOST_LISTED],
        "largest": sorted(book.records, key=lambda one: -one.size)[:_MOST_LISTED],
        "students": by_student(book),
        "titles": {exercise.id: exercise.title for exercise in book.exercises},
        "many": _many,
        "name_of": name_of,
        "number": number,
        "outcome": outcome,
        "problem": problem,
        "report_link": report_link,
        "score": score,
        "total": total,
    }


def _facts(book: Gradebook) -> Iterator[tuple[str, int]]:
    tally = book.tally()
    yield "students", len(book.students)
    yield "submissions", len(book.records)
    rare = {name: tally[name] for name in ("passed", "not passed", "crashed", "unreadable")}
    rare |= {"not graded: grader's error": tally["error"], "missing": len(book.missing)}
    yield from ((name, count) for name, count in rare.items() if count)


def _figure(exercise: Exercise, records: Sequence[Record]) -> Figure:
    points = [found for record in records if (found := score(record)) is not None]
    average, middle = (mean(points), median(points)) if points else (None, None)
    passed = sum(record.passed for record in records)
    return Figure(exercise, counts.distribution(exercise, records), len(records), passed, average, middle)


def _heat_maps(book: Gradebook) -> Iterator[HeatMap]:
    """Over the exercises, and for each over how well its submissions did."""
    if len(book.exercises) > 1:
        titles = [exercise.title for exercise in book.exercises]
        having = counts.having_diagnoses(book.graded())
        yield HeatMap("Submissions with a diagnosis, by exercise", titles, counts.diagnoses_by_exercise(book), having)
    for exercise in book.exercises:
        records = book.graded(exercise.id)
        title = f"{exercise.title}: submissions with a diagnosis, by score"
        having = counts.having_diagnoses(records)
        yield HeatMap(title, counts.BANDS, counts.diagnoses_by_band(records), having)


def _many(count: int, one: str) -> str:
    """`1 student`, `2 students`."""
    return f"{count} {one if count == 1 else one + 's'}"
