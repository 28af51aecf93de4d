"""The class page: one HTML file with everything in it, nothing fetched, of use without JavaScript, too.

What it says of a class is put together here, and `templates` write it down, each section one.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean, median
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from course_kit.classroom.exports import attention, lookalikes, texts
from course_kit.classroom.records import STUDENTS, outcome_of, safe_name
from course_kit.grading.model import catalogue
from course_kit.text.templates import render_template as fill_in

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.classroom.exports.changes import ResultChange
    from course_kit.classroom.records import Gradebook, GradeRecord
    from course_kit.grading.model.exercise import Exercise

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
_MOST_BARS = 21
BANDS = ("under 25 %", "25 to 50 %", "50 to 75 %", "75 % and more")


@dataclass(frozen=True)
class Bar:
    """One bar of a distribution: from `low` points on, up to the next one's."""

    low: float
    label: str
    count: int


@dataclass
class CheckCount:
    """How often a check came out how: by its status, and whose it is that failed."""

    id: str
    title: str
    points: float
    by_status: Counter[str] = field(default_factory=Counter)
    failed: list[GradeRecord] = field(default_factory=list)

    @property
    def run(self) -> int:
        """How often it could be run at all."""
        return self.by_status["passed"] + self.by_status["failed"]


@dataclass(frozen=True)
class Figure:
    """The scores of one exercise; `average` and `middle` are None where nobody has one."""

    exercise: Exercise
    bars: Sequence[Bar]
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
    having: dict[str, list[GradeRecord]]


def render_class(
    book: Gradebook, alike: lookalikes.LookAlikes | None = None, changes: Sequence[ResultChange] = ()
) -> str:
    """The page of a class run."""
    values = _values(book, alike, changes)
    contents = {name: fill_in(_TEMPLATES / f"{name}.html", **values).strip() for name in _SECTIONS}
    sections = [(name, title, contents[name]) for name, title in _SECTIONS.items() if contents[name]]
    return str(fill_in(_TEMPLATES / "class_page.html", sections=sections, **values))


def report_link(record: GradeRecord) -> str:
    """Where a submission's report lies, seen from the class page."""
    return quote(f"{STUDENTS}/{safe_name(record.entry.student)}/{record.entry.exercise}.html")


def _values(book: Gradebook, alike: lookalikes.LookAlikes | None, changes: Sequence[ResultChange]) -> dict[str, Any]:
    """What the templates name: the class, what was found out about it, and the functions that put it into words."""
    timed = [record for record in book.records if not record.same_as and record.report["duration_s"]]
    called = attention.label_students(book)
    if alike is None and book.records:
        alike = lookalikes.find_lookalikes(book)
    # The pairs themselves are what the groups hold.
    comparable = alike.pairs[: lookalikes.MOST_PAIRS] if alike and book.root else []
    comparison_links = {id(pair): lookalikes.link_to_pair(place) for place, pair in enumerate(comparable)}
    return {
        "book": book,
        "called": called,
        "absent": dict(book.absent),
        "groups": attention.group_by_attention(book, called),
        "changes": changes,
        "facts": list(_facts(book)),
        "layout": _LAYOUTS.get(book.layout, book.layout) or "unknown",
        "figures": [
            _figure(exercise, records) for exercise in book.exercises if (records := book.graded_records(exercise.id))
        ],
        "checks": [
            (exercise, found) for exercise in book.exercises if (found := count_checks(book.records_of(exercise.id)))
        ],
        "heat_maps": [table for table in _heat_maps(book) if table.rows],
        "diagnoses": catalogue.catalogue(),
        "alike": alike,
        "comparison_link": lambda pair: comparison_links.get(id(pair)),
        "threshold": lookalikes.THRESHOLD,
        "slowest": sorted(timed, key=lambda record: -float(record.report["duration_s"]))[:_MOST_LISTED],
        "largest": sorted(book.records, key=lambda record: -record.size)[:_MOST_LISTED],
        "students": texts.group_by_student(book),
        "titles": {exercise.id: exercise.title for exercise in book.exercises},
        "many": _count_noun,
        "name_of": texts.name_of,
        "number": texts.format_number,
        "outcome": outcome_of,
        "problem": texts.describe_problem,
        "report_link": report_link,
        "score": texts.score_of,
        "total": texts.total_score,
    }


def _facts(book: Gradebook) -> Iterator[tuple[str, int]]:
    tally = book.tally()
    yield "students", len(book.students)
    yield "submissions", len(book.records)
    rare = {name: tally[name] for name in ("passed", "not passed", "crashed", "unreadable")}
    rare |= {"not graded: grader's error": tally["error"], "missing": len(book.missing)}
    yield from ((name, count) for name, count in rare.items() if count)


def _figure(exercise: Exercise, records: Sequence[GradeRecord]) -> Figure:
    """How many have how many points: a bar for each point, or ten where there are many; the last is full marks."""
    points = [found for record in records if (found := texts.score_of(record)) is not None]
    average, middle = (mean(points), median(points)) if points else (None, None)
    passed = sum(record.passed for record in records)
    steps = int(exercise.points) if exercise.points == int(exercise.points) and exercise.points < _MOST_BARS else 10
    width = exercise.points / steps
    counts = Counter(min(steps, max(0, math.floor(point / width + 1e-9))) for point in points)
    bars = [Bar(step * width, f"{step * width:g}", counts[step]) for step in range(steps + 1)]
    return Figure(exercise, bars, len(records), passed, average, middle)


def _heat_maps(book: Gradebook) -> Iterator[HeatMap]:
    """Over the exercises, and for each over how well its submissions did."""
    if len(book.exercises) > 1:
        titles = [exercise.title for exercise in book.exercises]
        order = [exercise.id for exercise in book.exercises]
        caption = "Submissions with a diagnosis, by exercise"
        yield _heat_map(caption, titles, book.graded_records(), lambda record: order.index(record.entry.exercise))
    for exercise in book.exercises:
        caption = f"{exercise.title}: submissions with a diagnosis, by score"
        yield _heat_map(caption, BANDS, book.graded_records(exercise.id), _band)


def _heat_map(
    caption: str, columns: Sequence[str], records: Sequence[GradeRecord], column_of: Callable[[GradeRecord], int]
) -> HeatMap:
    """For each diagnosis how many records of each column have it, the most frequent first."""
    having: dict[str, list[GradeRecord]] = {}
    for record in records:
        for code in record.diagnoses:
            having.setdefault(code, []).append(record)
    rows = {}
    for code, found in sorted(having.items(), key=lambda item: (-len(item[1]), item[0])):
        counts = Counter(map(column_of, found))
        rows[code] = [counts[column] for column in range(len(columns))]
    return HeatMap(caption, columns, rows, having)


def _count_noun(count: int, noun: str) -> str:
    """`1 student`, `2 students`."""
    return f"{count} {noun if count == 1 else noun + 's'}"


def count_checks(records: Sequence[GradeRecord]) -> list[CheckCount]:
    """The checks of one exercise in the order they are run."""
    found: dict[str, CheckCount] = {}
    for record in records:
        for check in record.report["checks"]:
            tally = found.setdefault(check["id"], CheckCount(check["id"], check["title"], float(check["max_points"])))
            tally.by_status[check["status"]] += 1
            if check["status"] == "failed":
                tally.failed.append(record)
    return list(found.values())


def _band(record: GradeRecord) -> int:
    reached = record.score / record.max_score if record.max_score else 0.0
    return min(len(BANDS) - 1, int(reached * len(BANDS)))
