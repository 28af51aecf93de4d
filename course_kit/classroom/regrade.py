"""Grades an exercise of a class again, as when its grader was repaired: a table first, then the change.

New results lie in `regrade` beside the old ones until they are written, so that a command that was stopped, or only
looked, has not worked in vain.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom import submissions
from course_kit.classroom.exports.texts import csv_text, format_number, lines_of_table, score_of
from course_kit.classroom.grading_loop import ClassGrading, versions_of
from course_kit.classroom.records import RecordFolder, outcome_of
from course_kit.environment import write_atomically
from course_kit.grading.reading import Reader

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence

    from course_kit.classroom.grading_loop import RunProgress
    from course_kit.classroom.records import Gradebook, GradeRecord
    from course_kit.classroom.run import ClassRun
    from course_kit.classroom.submissions import ClassSubmission
    from course_kit.grading.pool import Graders

STAGING = "regrade"
TABLE = "regrade.csv"
HEADER = ("student", "name", "exercise", "was", "is", "checks that changed", "remarks")


@dataclass(frozen=True)
class GradeChange:
    """One line of the table: a result before and after, each with its penalty and override."""

    before: GradeRecord
    after: GradeRecord

    @property
    def checks(self) -> list[str]:
        """`robot_name: failed -> passed` for each check that came out otherwise."""
        old, new = _statuses(self.before), _statuses(self.after)
        return [
            f"{key}: {old.get(key, 'absent')} -> {new.get(key, 'absent')}"
            for key in dict.fromkeys((*old, *new))
            if old.get(key) != new.get(key)
        ]

    @property
    def is_one(self) -> bool:
        """Whether anything is different."""
        old, new = self.before, self.after
        return bool(self.checks) or (old.graded_score, old.status) != (new.graded_score, new.status)

    @property
    def row(self) -> list[str]:
        """Its cells, see `HEADER`."""
        entry, points = self.after.entry, (_points(self.before), _points(self.after))
        checks, remarks = "; ".join(self.checks), " ".join(self.after.remarks)
        return [entry.student, entry.name, entry.exercise, *points, checks, remarks]


def _statuses(record: GradeRecord) -> dict[str, str]:
    return {check["id"]: check["status"] for check in record.report["checks"]}


def _points(record: GradeRecord) -> str:
    points = score_of(record)
    return outcome_of(record) if points is None else f"{format_number(points)} ({outcome_of(record)})"


class Regrade:
    """One regrade of a class run's results."""

    def __init__(self, run: ClassRun, book: Gradebook, exercises: Collection[str], progress: RunProgress) -> None:
        self._run = run
        self._out = out = run.plan.out
        self._progress = progress
        self._exercises = {exercise.id: exercise for exercise in book.exercises}
        # A score for nothing handed in stays.
        self._chosen = [record for record in book.records if record.entry.source and record.entry.exercise in exercises]
        self._records = RecordFolder(out)
        self._staging = RecordFolder(out / STAGING)
        self._new: list[GradeRecord] = []
        self.complete = False

    def grade(self, start: Callable[[], Graders], stops: Callable[[], int]) -> list[GradeChange]:
        """Grade; what differs is returned and written into the table, and nothing else is written yet."""
        loop = ClassGrading(self._staging, self._progress, stops, self._run.hidden_folders)
        groups = self._take_stock(stops)
        if groups:
            graders = start()
            try:
                loop.run(groups, graders)
            finally:
                graders.close()
        self._new += loop.done
        self.complete = len(self._new) == len(self._chosen)
        changes = self._changes()
        rows = [HEADER, *(change.row for change in changes)]
        write_atomically(self._out / TABLE, csv_text(rows, mark=True))
        return changes

    @property
    def failed(self) -> list[GradeRecord]:
        """New results that are none, as the grader itself failed; the old ones stay."""
        return [record for record in self._new if record.status == "error"]

    def write(self) -> Gradebook:
        """Let the new results take the place of the old ones, which go to `superseded`."""
        before = {_key(record): record for record in self._chosen}
        for record in self._new:
            if record.status == "error":
                continue
            old = self._records.find(record.entry)
            if old is None or GradeChange(before[_key(record)], record).is_one:
                page = self._staging.path(record.entry, ".html").read_text(encoding="utf-8")
                self._records.keep(record, page)
            else:  # the same by other rules
                self._records.keep(replace(old, versions=record.versions))
        shutil.rmtree(self._staging.folder.parent, ignore_errors=True)
        return self._run.as_it_is()

    def _changes(self) -> list[GradeChange]:
        """What differs, by student and exercise, each with what the instructor's files make of it."""
        before = {_key(record): record for record in self._chosen}
        pairs = []
        for record in sorted(self._new, key=_key):
            old = before[_key(record)]
            if record.status != "error":
                now = self._run.instructions.adjust_record(record, self._run.exercises)
                pairs.append(GradeChange(old, now))
        return [change for change in pairs if change.is_one]

    def _take_stock(self, stops: Callable[[], int]) -> list[list[ClassSubmission]]:
        """Read what is graded again; identical ones together."""
        now = {exercise.id: versions_of(exercise) for exercise in self._exercises.values()}
        found = ((record, self._find_staged(record, now)) for record in self._chosen)
        with Reader(lambda: stops() > 0, memory=self._run.reader.memory) as reader:
            ready, groups = submissions.sort_out((self._read(old, reader, staged), staged) for old, staged in found)
        self._new += [staged for _, staged in ready]
        self._progress.begin(len(self._chosen), self._new)
        return groups

    def _find_staged(self, record: GradeRecord, now: dict[str, dict[str, str]]) -> GradeRecord | None:
        """What an earlier regrade has found, by the rules of now."""
        staged = self._staging.find(record.entry)
        return staged if staged is not None and staged.versions == now[record.entry.exercise] else None

    def _read(self, record: GradeRecord, reader: Reader, staged: GradeRecord | None) -> ClassSubmission:
        exercise = self._exercises[record.entry.exercise]
        seed = self._run.seed if record.seed is None else record.seed
        return submissions.read_submission(record.entry, self._run.intake.root, exercise, seed, reader, known=staged)


def _key(record: GradeRecord) -> tuple[str, str]:
    return (record.entry.student, record.entry.exercise)


def change_table(changes: Sequence[GradeChange]) -> Iterator[str]:
    """The table for a terminal, line by line."""
    name = HEADER.index("name")
    rows: list[Sequence[str]] = [HEADER, *(change.row for change in changes)]
    return lines_of_table([[*row[:name], *row[name + 1 :]] for row in rows])


def graded_otherwise(book: Gradebook) -> dict[str, int]:
    """How many results of each exercise were graded by another kit, exercise or grader than those of now."""
    found = {}
    for exercise in book.exercises:
        now = versions_of(exercise)
        others = [record for record in book.records_of(exercise.id) if record.entry.source and record.versions != now]
        found.update({exercise.id: len(others)} if others else {})
    return found
