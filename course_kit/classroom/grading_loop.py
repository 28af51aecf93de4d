"""Has submissions of a class graded, keeps each result the moment it is there, and says how far it is."""

from __future__ import annotations

import hashlib
import time
from collections import Counter
from dataclasses import replace
from functools import lru_cache
from importlib import metadata
from typing import IO, TYPE_CHECKING

from course_kit import environment
from course_kit.classroom.exports.report_page import render_page
from course_kit.classroom.records import outcome_of
from course_kit.grading.model import exercise_folders
from course_kit.grading.pool import grade_all

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    from course_kit.classroom.records import GradeRecord, RecordFolder
    from course_kit.classroom.submissions import ClassSubmission
    from course_kit.grading.engine import GradingRequest
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.report import Report
    from course_kit.grading.pool import Graders

_ORDER = ("passed", "not passed", "crashed", "unreadable", "error")
_EVERY_S = 10.0  # between two lines where lines cannot be written over
_TOO_EARLY = 3  # results before an estimate is worth anything
_MINUTE = 60
_DISTRIBUTION = "ros2-course-kit"
_DIGITS = 12  # hexadecimal
_SOURCES = (".py", ".toml", ".msg", ".srv", ".action")
_PACKAGES = ("grading", "graders", "quiz", "ros")  # that have a part in a verdict


class RunProgress:
    """How a run goes: a line that is written over on a terminal, a line now and then elsewhere."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream
        self._live = stream.isatty()
        self._counts: Counter[str] = Counter()
        self._total = self._before = self._now = 0
        self._began = self._shown = time.monotonic()

    def begin(self, total: int, ready: Sequence[GradeRecord]) -> None:
        """So many submissions, and the results that exist; what was counted before is over."""
        self._total, self._before, self._now = total, len(ready), 0
        self._counts = Counter(outcome_of(record) for record in ready)
        self._began = time.monotonic()
        known = f", {len(ready)} of them already have a result from an earlier run" if ready else ""
        self._print(f"{total} submission{'s' * (total != 1)}{known}.")

    def count_result(self, record: GradeRecord) -> None:
        """One more has its result."""
        self._now += 1
        self._counts[outcome_of(record)] += 1

    def tick(self) -> None:
        """Some time has passed."""
        now = time.monotonic()
        if self._live:
            self._stream.write(f"\r\x1b[K{self.line()}")
            self._stream.flush()
        elif now - self._shown >= _EVERY_S:
            self._shown = now
            self._print(self.line())

    def announce_stop(self, under_way: int) -> None:
        """Ctrl-C: nothing new is begun, so many are finished."""
        self._print(f"Stopping once {under_way} running gradings have finished. Press Ctrl-C again to abandon them.")

    def end(self) -> None:
        """Leave the last state standing."""
        self._print(self.line())

    def line(self) -> str:
        """`[ 37/300] 20 passed, 12 not passed; about 1 min 20 s left`."""
        count = self._before + self._now
        width = len(str(self._total))
        counts = ", ".join(f"{self._counts[name]} {name}" for name in _ORDER if self._counts[name])
        return f"[{count:>{width}}/{self._total}]{' ' if counts else ''}{counts}{self._estimate_time_left(count)}"

    def _estimate_time_left(self, count: int) -> str:
        if self._now < _TOO_EARLY or count >= self._total:
            return ""
        seconds = round((self._total - count) * (time.monotonic() - self._began) / self._now)
        minutes, rest = divmod(seconds, _MINUTE)
        return f"; about {f'{minutes} min ' if minutes else ''}{rest} s left"

    def _print(self, line: str) -> None:
        self._stream.write(f"\r\x1b[K{line}\n" if self._live else f"{line}\n")
        self._stream.flush()


class ClassGrading:
    """Has submissions graded until all is done or somebody has asked to stop; what has its result stands in `done`."""

    def __init__(
        self,
        records: RecordFolder,
        progress: RunProgress,
        stops: Callable[[], int],
        hidden: tuple[str, ...],
        *,
        require_isolation: bool = False,
    ) -> None:
        self._records = records
        self._progress = progress
        self._stops = stops
        self._hidden = hidden
        self._require_isolation = require_isolation
        self._versions: dict[str, dict[str, str]] = {}
        self._is_stopping = False
        self.done: list[GradeRecord] = []

    def run(self, groups: Sequence[list[ClassSubmission]], graders: Graders) -> None:
        """Grade each group once; those in one are identical."""
        requests = ((group, self._request(group[0])) for group in groups)
        for group, report in grade_all(graders, requests, self._stops, self._listen):
            self._keep(group, report)
        self._progress.tick()

    def _request(self, first: ClassSubmission) -> GradingRequest | Report:
        return first.request(self._hidden, require_isolation=self._require_isolation) or first.report_unreadable()

    def _listen(self, under_way: int) -> None:
        if self._stops() and not self._is_stopping:
            self._is_stopping = True
            self._progress.announce_stop(under_way)
        self._progress.tick()

    def _keep(self, group: list[ClassSubmission], report: Report) -> None:
        """Write the result of a submission and of those identical to it."""
        first = group[0]
        exercise = first.exercise
        if exercise.id not in self._versions:
            self._versions[exercise.id] = versions_of(exercise)
        for twin in group:
            own, same_as = (report, "") if twin is first else (twin.own_report(report, first), first.entry.student)
            record = replace(twin.record(own), versions=self._versions[exercise.id], same_as=same_as)
            self._records.keep(record, render_page(own, twin.entry.name or twin.entry.student, twin.text))
            self.done.append(record)
            self._progress.count_result(record)


def versions_of(exercise: Exercise) -> dict[str, str]:
    """Fingerprints of the kit and an exercise: results with the same two were graded by the same rules."""
    apart = {exercise.folder / exercise.starter, exercise.folder / exercise_folders.PROOF}
    found = (path for path in exercise.folder.rglob("*") if path.suffix in _SOURCES and path.is_file())
    return {"kit": _version(), "exercise": _fingerprint(path for path in found if not apart & {path, *path.parents})}


@lru_cache(maxsize=1)
def _version() -> str:
    try:
        version = metadata.version(_DISTRIBUTION)
    except metadata.PackageNotFoundError:  # run from its folder
        version = "0"
    files = (path for name in _PACKAGES for path in (environment.PACKAGE / name).rglob("*"))
    return f"{version}+{_fingerprint(path for path in files if path.suffix in _SOURCES)}"


def _fingerprint(paths: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(f"{path.name}\0".encode(errors="surrogateescape"))
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:_DIGITS]
