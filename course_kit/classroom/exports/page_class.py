"""The class page's first half: how the class did, exercise by exercise and student by student."""

from __future__ import annotations

from dataclasses import dataclass, replace
from statistics import mean, median
from typing import TYPE_CHECKING

from course_kit.classroom.exports import charts, counts
from course_kit.classroom.exports.markup import TableCell, amount, many, report, section, share, shown, table
from course_kit.classroom.exports.results import MISSING, by_student, name_of, score, total
from course_kit.classroom.exports.texts import html, number
from course_kit.classroom.gradebook import outcome

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record
    from course_kit.grading.exercise import Exercise

_SIGNS = {"passed": "✓", "not passed": "✗", "crashed": "✗", "unreadable": "✗", "error": "!", MISSING: "–"}  # noqa: RUF001
_STATES = {"error": "grader's error"}


@dataclass(frozen=True)
class Part:
    """One part of the page; without content it is left out."""

    name: str
    title: str
    content: str

    def html(self) -> str:
        """The part as HTML."""
        return section(self.name, self.title, self.content)


def sections(book: Gradebook) -> list[Part]:
    """Scores and checks."""
    return [Part("scores", "Scores", _scores(book)), Part("checks", "Checks", _checks(book))]


def students(book: Gradebook) -> Part:
    """Everybody, with links to the reports."""
    return Part("students", "Students", _students(book))


def _scores(book: Gradebook) -> str:
    figures = "".join(
        _figure(exercise, records) for exercise in book.exercises if (records := book.graded(exercise.id))
    )
    return (
        f'{charts.hatching()}<div class="charts">{figures}</div>' if figures else "<p>No student has a grade yet.</p>"
    )


def _figure(exercise: Exercise, records: list[Record]) -> str:
    bars = counts.distribution(exercise, records)
    points = [found for record in records if (found := score(record)) is not None]
    passed = sum(record.report["passed"] for record in records)
    told = f"{passed} of {many(len(records), 'submission')} passed ({share(passed, len(records))})"
    if points:
        average, middle = (number(round(one(points), 1)) for one in (mean, median))
        told += f"; mean {average}, median {middle} of {number(exercise.points)}"
    name = html(f"Distribution of scores, {exercise.title}. The numbers are in the table below.")
    rows = [(f"{bar.label} points", amount(bar.count)) for bar in bars]
    numbers = table(
        f"{html(exercise.title)}: number of submissions by points", ["Points", "Submissions"], rows, kind="plain"
    )
    return (
        f"<figure><figcaption>{html(exercise.title)}<small>{told}</small></figcaption>"
        f"{charts.histogram(bars, exercise.pass_mark, name)}"
        f"<details><summary>The numbers</summary>{numbers}</details></figure>"
    )


def _checks(book: Gradebook) -> str:
    return "".join(_check_table(exercise, records) for exercise in book.exercises if (records := book.of(exercise.id)))


def _check_table(exercise: Exercise, records: list[Record]) -> str:
    found = counts.checks(records)
    if not found:
        return ""
    columns = ["Check", "Points", "Not passed", "Of those run", "Passed", "Not run"]
    errors = any(check.by_status["error"] for check in found)
    rows = [_check_row(check, errors=errors) for check in found]
    title = f"{html(exercise.title)}: how often each check fails"
    return table(title, [*columns, "Grader's error"] if errors else columns, rows)


def _check_row(check: counts.CheckCount, *, errors: bool) -> list[TableCell | str]:
    failed = check.by_status["failed"]
    part = TableCell(f"{charts.meter(failed, check.run)} {share(failed, check.run)}", str(failed / max(1, check.run)))
    row: list[TableCell | str] = [shown(check.title), amount(check.points), amount(failed), replace(part, number=True)]
    row += [amount(check.by_status["passed"]), amount(check.by_status["skipped"])]
    return [*row, amount(check.by_status["error"])] if errors else row


def _students(book: Gradebook) -> str:
    if not book.students:
        return "<p>No student has handed in anything.</p>"
    find = (
        '<p class="find" hidden><label for="find">Find a student</label><input id="find" type="search" '
        'autocomplete="off"><span id="found" role="status"></span></p>'
    )
    names = ["Name"] if any(record.entry.name for record in book.records) else []
    kind = "sortable named" if names else "sortable"
    columns = ["Student", *names, *(html(exercise.title) for exercise in book.exercises), "Total"]
    caption = f"{many(len(book.students), 'student')}; a score leads to its report"
    return find + table(caption, columns, _student_rows(book, names=bool(names)), kind=kind, id_="class")


def _student_rows(book: Gradebook, *, names: bool) -> Iterator[list[TableCell | str]]:
    for student, records in by_student(book).items():
        results = [_result(records.get(exercise.id), exercise) for exercise in book.exercises]
        name: list[TableCell | str] = [shown(name_of(records))] if names else []
        yield [shown(student), *name, *results, _total(records)]


def _total(records: dict[str, Record]) -> TableCell:
    reached = total(records)
    return TableCell("not known yet", "") if reached is None else amount(reached)


def _result(record: Record | None, exercise: Exercise) -> TableCell:
    if record is None:
        return TableCell(f'<span class="state">{_SIGNS[MISSING]} {MISSING}</span>', "")
    found, state = score(record), outcome(record)
    points = "not graded" if found is None else f"{number(found)} of {number(exercise.points)}"
    late = ", late" if record.entry.late else ""
    return TableCell(
        f'<a href="{report(record)}">{points}</a> '
        f'<span class="state"><span aria-hidden="true">{_SIGNS[state]}</span> {_STATES.get(state, state)}{late}</span>',
        "" if found is None else number(found),
    )
