"""What the instructor has laid into the folder of the results, read before anything is graded: rules and decisions.

`overrides.csv` has scores set by hand, for an exercise or for one check, added points (`+1`), comments for students.
No run writes these files, and each run reads them anew.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.records import Entry, GradeRecord
from course_kit.classroom.rules import deadlines
from course_kit.classroom.rules.deadlines import SUBMITTED_AT
from course_kit.classroom.rules.people import (
    Mistakes,
    StudentTable,
    describe_unknown,
    parse_number,
    read_rows,
    require_none,
)
from course_kit.grading import engine

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from course_kit.classroom.records import Gradebook
    from course_kit.classroom.rules.adjustments import Adjustment
    from course_kit.classroom.rules.deadlines import Deadlines
    from course_kit.classroom.rules.people import People
    from course_kit.grading.model.exercise import Exercise


_NOTHING = "Nothing was handed in."
_MOST_NAMED = 10
OVERRIDES = "overrides.csv"


@dataclass(frozen=True)
class Instructions:
    """Due dates, extensions, overrides and comments."""

    deadlines: Deadlines
    overrides: StudentTable[Override]

    def match_people(self, people: People) -> Instructions:
        """Those by the students of a class, whom the files may call by any of their names."""
        extensions, overrides = self.deadlines.extensions.match_people(people), self.overrides.match_people(people)
        require_none([extensions.mistakes, overrides.mistakes])
        return Instructions(replace(self.deadlines, extensions=extensions), overrides)

    def apply(self, book: Gradebook) -> Gradebook:
        """The gradebook with lateness, penalties, overrides and comments."""
        exercises = {exercise.id: exercise for exercise in book.exercises}
        stand_ins, missing = self._without_submission(book, exercises)
        records = [self.adjust_record(record, book.exercises) for record in book.records]
        everybody = sorted([*records, *stand_ins], key=lambda record: (record.entry.student, record.entry.exercise))
        return replace(book, records=tuple(everybody), missing=tuple(missing))

    def adjust_record(self, record: GradeRecord, exercises: Sequence[Exercise]) -> GradeRecord:
        """A result with its lateness, penalty, override and comment."""
        entry = record.entry
        exercise = next(exercise for exercise in exercises if exercise.id == entry.exercise)
        moment = deadlines.parse_stamp(entry.platform.get(SUBMITTED_AT, ""), self.deadlines.zone)
        found = self.deadlines.judge(entry.student, exercise, moment, marked=entry.late)
        if decided := self.overrides.find(entry.student, exercise.id):
            found = replace(found, override=decided.score, added=decided.added, comment=decided.comment)
            found = _with_checks(found, decided, record)
        return replace(record, adjustment=found)

    def _without_submission(
        self, book: Gradebook, exercises: dict[str, Exercise]
    ) -> tuple[list[GradeRecord], list[tuple[str, str]]]:
        known = {entry.student: entry for entry in (*(record.entry for record in book.records), *book.others)}
        stand_ins, others = [], []
        for student, exercise_id in book.missing:
            decided = self.overrides.find(student, exercise_id)
            if decided is None or decided.score is None:
                others.append((student, exercise_id))
                continue
            exercise = exercises[exercise_id]
            report = engine.report_unreadable(exercise, "", _NOTHING).to_mapping()
            who = known.get(student, Entry(student, exercise_id, ""))
            entry = Entry(student, exercise_id, "", who.name, platform=who.platform)
            record = GradeRecord(entry, "", 0, None, report, title=exercise.title)
            adjustment = self.deadlines.judge(student, exercise, None, marked=False)
            adjustment = replace(adjustment, override=decided.score, comment=decided.comment, warning="")
            stand_ins.append(replace(record, adjustment=adjustment))
        return stand_ins, others


def _with_checks(adjustment: Adjustment, decided: Override, record: GradeRecord) -> Adjustment:
    """Set the points of single checks; one that the result does not have is named."""
    there = {check["id"]: check for check in record.report["checks"]}
    known = [(there[name], points) for name, points in decided.checks if name in there]
    changed = tuple((str(check["title"]), float(check["points"]), points) for check, points in known)
    absent = [name for name, _ in decided.checks if name not in there]
    if not absent:
        return replace(adjustment, checks=changed)
    warning = f"{OVERRIDES} sets points of {', '.join(absent)}, and the result has no such check"
    return replace(adjustment, checks=changed, warning="; ".join(filter(None, (adjustment.warning, warning))))


def read_instructions(folder: Path, exercises: Sequence[Exercise]) -> Instructions:
    """Read the instructor's files in the folder of the results."""
    return Instructions(deadlines.read_deadlines(folder, exercises), read_overrides(folder / OVERRIDES, exercises))


def moment_warnings(book: Gradebook) -> Iterator[str]:
    """What is not clear about when submissions were handed in, a sentence for each reason."""
    reasons: dict[str, list[str]] = {}
    for record in book.records:
        if record.adjustment.warning:
            reasons.setdefault(record.adjustment.warning, []).append(record.entry.label)
    for reason, students in reasons.items():
        named = ", ".join(dict.fromkeys(students[:_MOST_NAMED]))
        more = len(students) - _MOST_NAMED
        yield (
            f"{len(students)} submission{'s' * (len(students) != 1)}: {reason}: "
            f"{named}{f' and {more} more' if more > 0 else ''}."
        )


@dataclass(frozen=True)
class Override:
    """What the lines of the file say of a student's exercise."""

    score: float | None = None  # the points instead of those of the checks, or None
    added: float = 0.0  # the points on top of those of the checks, written with a plus; 0 without any
    comment: str = ""  # for the student
    checks: tuple[tuple[str, float], ...] = ()  # ids of checks, each with the points instead of those it gave


def read_overrides(path: Path, exercises: Sequence[Exercise]) -> StudentTable[Override]:
    """Read the file."""
    table: StudentTable[Override] = StudentTable(mistakes := Mistakes(path))
    if not path.exists():
        return table
    points = {exercise.id: exercise.points for exercise in exercises}
    lines: dict[tuple[str, str, str], int] = {}
    for row in read_rows(path, ("student", "exercise"), ("score", "comment", "check")):
        student, exercise, check = row.cells["student"], row.cells["exercise"], row.cells["check"]
        text, comment = row.cells["score"], row.cells["comment"]
        score = parse_number(text)
        if exercise not in points:
            mistakes.add(row.line, describe_unknown("exercise", exercise, points))
        elif not student:
            mistakes.add(row.line, "the student is missing")
        elif (line := lines.setdefault((student, exercise, check), row.line)) != row.line:
            what = f"the check {check}" if check else exercise
            mistakes.add(row.line, f"{student} and {what} stand in line {line} already")
        elif text and (score is None or not 0 <= score <= points[exercise]):
            mistakes.add(row.line, f"the score '{text}' is not a number from 0 to {points[exercise]:g}")
        elif check and (score is None or text.startswith("+")):
            mistakes.add(row.line, f"the check {check} needs the points that it is worth, such as 1.5")
        elif not text and not comment:
            mistakes.add(row.line, "it has neither a score nor a comment")
        else:
            before, line = table.said.get((student, exercise), (Override(), row.line))
            table.said[student, exercise] = (_with_row(before, row.cells, score), line)
    return table


def _with_row(before: Override, cells: Mapping[str, str], score: float | None) -> Override:
    """What the lines before say of a student and exercise, and one more."""
    comments = " ".join(filter(None, (before.comment, cells["comment"])))
    if cells["check"]:
        return replace(before, comment=comments, checks=(*before.checks, (cells["check"], score or 0.0)))
    if cells["score"].startswith("+"):
        return replace(before, comment=comments, added=score or 0.0)
    return replace(before, comment=comments, score=score)
