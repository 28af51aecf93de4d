"""What the instructor has laid into the folder of the results, read before anything is graded: rules and decisions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.records import Entry, Record
from course_kit.classroom.rules import deadlines, overrides
from course_kit.classroom.rules.submission_times import submitted
from course_kit.classroom.rules.tables import require_none
from course_kit.grading import engine

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.rules.adjustments import Adjustment
    from course_kit.classroom.rules.deadlines import Deadlines
    from course_kit.classroom.rules.overrides import Override, Overrides
    from course_kit.classroom.rules.people import People
    from course_kit.grading.exercise import Exercise

_NOTHING = "Nothing was handed in."
_MOST_NAMED = 10


@dataclass(frozen=True)
class Instructions:
    """Due dates, extensions, overrides and comments."""

    deadlines: Deadlines
    overrides: Overrides

    def of(self, people: People) -> Instructions:
        """Those by the students of a class, whom the files may call by any of their names."""
        found = Instructions(self.deadlines.of(people), self.overrides.of(people))
        require_none(one for one in (found.deadlines.mistakes, found.overrides.mistakes) if one is not None)
        return found

    def apply(self, book: Gradebook) -> Gradebook:
        """The gradebook with lateness, penalties, overrides and comments."""
        exercises = {one.id: one for one in book.exercises}
        stand_ins, missing = self._without_submission(book, exercises)
        records = [self.adjusted(record, book.exercises) for record in book.records]
        everybody = sorted([*records, *stand_ins], key=lambda one: (one.entry.student, one.entry.exercise))
        return replace(book, records=tuple(everybody), missing=tuple(missing))

    def adjusted(self, record: Record, exercises: Sequence[Exercise]) -> Record:
        """A result with its lateness, penalty, override and comment."""
        entry = record.entry
        exercise = next(one for one in exercises if one.id == entry.exercise)
        moment = submitted(entry, self.deadlines.zone)
        found = self.deadlines.judge(entry.student, exercise, moment, marked=entry.late)
        if decided := self.overrides.find(entry.student, exercise.id):
            found = replace(found, override=decided.score, added=decided.added, comment=decided.comment)
            found = _with_checks(found, decided, record)
        return replace(record, adjustment=found)

    def _without_submission(
        self, book: Gradebook, exercises: dict[str, Exercise]
    ) -> tuple[list[Record], list[tuple[str, str]]]:
        known = {one.student: one for one in (*(record.entry for record in book.records), *book.others)}
        stand_ins, others = [], []
        for student, exercise in book.missing:
            decided = self.overrides.find(student, exercise)
            if decided is None or decided.score is None:
                others.append((student, exercise))
                continue
            task = exercises[exercise]
            report = engine.unreadable(task, "", _NOTHING).to_mapping()
            who = known.get(student, Entry(student, exercise, ""))
            entry = Entry(student, exercise, "", who.name, platform=who.platform)
            record = Record(entry, "", 0, None, report, title=task.title)
            adjustment = self.deadlines.judge(student, task, None, marked=False)
            adjustment = replace(adjustment, override=decided.score, comment=decided.comment, warning="")
            stand_ins.append(replace(record, adjustment=adjustment))
        return stand_ins, others


def _with_checks(adjustment: Adjustment, decided: Override, record: Record) -> Adjustment:
    """Set the points of single checks; one that the result does not have is named."""
    there = {check["id"]: check for check in record.report["checks"]}
    known = [(there[name], points) for name, points in decided.checks if name in there]
    changed = tuple((str(check["title"]), float(check["points"]), points) for check, points in known)
    absent = [name for name, _ in decided.checks if name not in there]
    if not absent:
        return replace(adjustment, checks=changed)
    warning = f"{overrides.FILE} sets points of {', '.join(absent)}, and the result has no such check"
    return replace(adjustment, checks=changed, warning="; ".join(filter(None, (adjustment.warning, warning))))


def read(folder: Path, exercises: Sequence[Exercise]) -> Instructions:
    """Read the instructor's files in the folder of the results."""
    return Instructions(deadlines.read(folder, exercises), overrides.read(folder / overrides.FILE, exercises))


def warnings(book: Gradebook) -> Iterator[str]:
    """What is not clear about when submissions were handed in, a sentence for each reason."""
    reasons: dict[str, list[str]] = {}
    for record in book.records:
        if record.adjustment.warning:
            reasons.setdefault(record.adjustment.warning, []).append(record.entry.called)
    for reason, students in reasons.items():
        named = ", ".join(dict.fromkeys(students[:_MOST_NAMED]))
        more = len(students) - _MOST_NAMED
        yield (
            f"{len(students)} submission{'s' * (len(students) != 1)}: {reason}: "
            f"{named}{f' and {more} more' if more > 0 else ''}."
        )
