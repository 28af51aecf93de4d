"""Submissions of a class as they were read: the text of each, or why it has none, and which are the same."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.records import GradeRecord
from course_kit.grading import engine
from course_kit.grading.engine import GradingRequest
from course_kit.grading.errors import GradingError
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import ReadingStoppedError, copy_file

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from course_kit.classroom.records import Entry
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.report import Report
    from course_kit.grading.model.submission import Submission
    from course_kit.grading.reading import Reader


@dataclass(frozen=True)
class ClassSubmission:
    """A submission that has been read."""

    entry: Entry  # who handed it in, and where it lies
    exercise: Exercise  # what it is for
    seed: int  # what its checks draw from
    digest: str = ""  # SHA-256 of kind and bytes; empty when it could not be read
    size: int = 0  # of its program in bytes, not of a notebook's outputs
    text: Submission | None = None  # its text, or None; then `problem` says why
    problem: str = ""  # why it cannot be graded
    # of the report of one that cannot be graded: "unreadable", or "error" where that is not its own fault
    status: str = "unreadable"

    @property
    def key(self) -> tuple[str, str, int]:
        """Equal for submissions that get the same report; what could not be read is equal to nothing else."""
        return (self.exercise.id, self.digest or self.entry.source, self.seed)

    @property
    def may_last(self) -> bool:
        """Whether its program may loop or wait for long, by a guess from its text."""
        return self.text is not None and (self.text.facts.loops or self.text.facts.waits)

    def request(self, hidden: tuple[str, ...], *, require_isolation: bool) -> GradingRequest | None:
        """What an executor is asked to do; None when there is nothing to run."""
        if self.text is None:
            return None
        name = self.entry.source
        return GradingRequest(self.exercise, self.text, name, self.seed, hidden, require_isolation=require_isolation)

    def report_unreadable(self) -> Report:
        """The report of one that has no text."""
        return engine.report_unreadable(self.exercise, self.entry.source, self.problem, self.status)

    def record(self, report: Report) -> GradeRecord:
        """Its result."""
        return GradeRecord(
            entry=self.entry,
            digest=self.digest,
            size=self.size,
            seed=self.seed,
            report=report.to_mapping(),
            title=report.title,
            isolation=report.isolation,
            wall_s=round(report.duration_s, 3),
        )

    def own_report(self, report: Report, twin: ClassSubmission) -> Report:
        """Its report where an identical submission was graded: what names the twin's file names its own."""
        if self.text is None or twin.text is None:
            return replace(report, submission=self.entry.source)
        names = {twin.text.name: self.text.name, twin.text.program: self.text.program}
        found = re.compile(rf"(?<!\w)(?:{'|'.join(map(re.escape, names))})(?!\w)")

        def undo(text: str) -> str:
            return found.sub(lambda name: names[name[0]], text)

        return replace(
            report,
            submission=self.entry.source,
            checks=tuple(
                replace(old, message=undo(old.message), told=undo(old.told), got=undo(old.got)) for old in report.checks
            ),
            stdout=undo(report.stdout),
            stderr=undo(report.stderr),
            problem=undo(report.problem),
        )

    def has_result(self, record: GradeRecord) -> bool:
        """Whether a record is of this submission as it is now, wherever it lies; a grader's error gets another try."""
        if record.status == "error" or (record.digest, record.seed) != (self.digest, self.seed):
            return False
        return bool(self.digest) or record.entry.source == self.entry.source

    def kept_record(self, record: GradeRecord) -> GradeRecord:
        """The result it has, as of what was handed in now: it may have got a name, a time or another place."""
        if record.entry == self.entry:
            return record
        return replace(record, entry=self.entry, report={**record.report, "submission": self.entry.source})


def sort_out(
    read: Iterable[tuple[ClassSubmission, GradeRecord | None]],
) -> tuple[list[tuple[ClassSubmission, GradeRecord]], list[list[ClassSubmission]]]:
    """Those that have a result, with it; and the others: identical ones together, first what may last."""
    ready: list[tuple[ClassSubmission, GradeRecord]] = []
    groups: dict[tuple[str, str, int], list[ClassSubmission]] = {}
    try:
        for submission, known in read:
            if known is not None and submission.has_result(known):
                ready.append((submission, known))
            else:
                groups.setdefault(submission.key, []).append(submission)
    except ReadingStoppedError:
        groups = {}
    return ready, sorted(groups.values(), key=lambda group: not group[0].may_last)


def read_submission(  # noqa: PLR0913 - what a submission is read for
    entry: Entry, root: Path, exercise: Exercise, seed: int, reader: Reader, *, known: GradeRecord | None = None
) -> ClassSubmission:
    """Read a submission; never fails, as there is a report for whatever was handed in."""
    path = root / entry.source
    try:
        with copy_file(path, several=bool(exercise.files)) as copy:
            submission = ClassSubmission(entry, exercise, seed, copy.digest, copy.size)
            if known is not None and submission.has_result(known):
                return submission
            text = reader.read(copy, exercise)
            return replace(submission, text=text, size=len(text.source.encode(errors="replace")))
    except UnreadableError as problem:
        if not os.path.lexists(path):
            sentence = f"{path.name} is no longer there: it was removed while the class was graded."
            return ClassSubmission(entry, exercise, seed, problem=sentence, status="error")
        return ClassSubmission(entry, exercise, seed, problem=str(problem), size=_size(path))
    except GradingError as problem:
        return ClassSubmission(entry, exercise, seed, problem=str(problem), size=_size(path), status="error")


def _size(path: Path) -> int:
    try:
        return path.lstat().st_size
    except OSError:
        return 0
