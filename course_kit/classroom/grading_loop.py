"""Has submissions graded by an executor, keeps each result the moment it is there, and says how far it is."""

from __future__ import annotations

import hashlib
import time
from collections import Counter
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import replace
from functools import lru_cache
from importlib import metadata
from typing import IO, TYPE_CHECKING

from course_kit import environment
from course_kit.classroom.records import outcome_of
from course_kit.grading import engine
from course_kit.grading.model import exercise_folders
from course_kit.grading.render.html import render_page

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from concurrent.futures import Future
    from pathlib import Path

    from course_kit.classroom.executors import Executor
    from course_kit.classroom.records import GradeRecord, RecordFolder
    from course_kit.classroom.submissions import ClassSubmission
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.report import Report

_AHEAD = 2  # requests given to an executor for each of its slots: none idles, and few are lost
_LISTEN_S = 0.5  # how often a wait for results looks at the clock and at who wants to stop
_AT_ONCE = 2  # requests to stop
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

    def __init__(self, stream: IO[str], clock: Callable[[], float] = time.monotonic) -> None:
        self._stream = stream
        self._clock = clock
        self._live = stream.isatty()
        self._counts: Counter[str] = Counter()
        self._total = self._before = self._now = 0
        self._began = self._shown = clock()

    def begin(self, total: int, ready: Sequence[GradeRecord]) -> None:
        """So many submissions, and the results that are there already; whatever was counted before is over."""
        self._total, self._before, self._now = total, len(ready), 0
        self._counts = Counter(outcome_of(record) for record in ready)
        self._began = self._clock()
        known = f", {len(ready)} of them already have a result from an earlier run" if ready else ""
        self._print(f"{total} submission{'s' * (total != 1)}{known}.")

    def done(self, record: GradeRecord) -> None:
        """One more has its result."""
        self._now += 1
        self._counts[outcome_of(record)] += 1

    def tick(self) -> None:
        """Some time has passed."""
        now = self._clock()
        if self._live:
            self._stream.write(f"\r\x1b[K{self.line()}")
            self._stream.flush()
        elif now - self._shown >= _EVERY_S:
            self._shown = now
            self._print(self.line())

    def stopping(self, under_way: int) -> None:
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
        return f"[{count:>{width}}/{self._total}]{' ' if counts else ''}{counts}{self._left(count)}"

    def _left(self, count: int) -> str:
        if self._now < _TOO_EARLY or count >= self._total:
            return ""
        seconds = round((self._total - count) * (self._clock() - self._began) / self._now)
        minutes, rest = divmod(seconds, _MINUTE)
        return f"; about {f'{minutes} min ' if minutes else ''}{rest} s left"

    def _print(self, line: str) -> None:
        self._stream.write(f"\r\x1b[K{line}\n" if self._live else f"{line}\n")
        self._stream.flush()


class GradingLoop:
    """Gives an executor enough to do, until all is done or somebody has asked to stop."""

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
        self.done: list[GradeRecord] = []

    def run(self, groups: Sequence[list[ClassSubmission]], executor: Executor) -> None:
        """Grade each group once; those in one are identical. What has its result stands in `done`."""
        waiting = iter(groups)
        under_way: dict[Future[Report], list[ClassSubmission]] = {}
        stopping = False
        while self._stops() < _AT_ONCE:
            if self._stops() and not stopping:
                stopping = True
                for future in [future for future in under_way if future.cancel()]:
                    del under_way[future]
                self._progress.stopping(len(under_way))
            if not stopping:
                self._fill(executor, waiting, under_way)
            if not under_way:
                return
            finished, _ = wait(under_way, _LISTEN_S, FIRST_COMPLETED)
            for future in [one for one in under_way if one in finished]:  # in the order they were given out
                result = _result(under_way[future][0], future)
                if result.status == "error":
                    executor.require_reachable()  # an error that comes of that is of no submission
                self._keep(under_way.pop(future), result)
            executor.require_reachable()
            self._progress.tick()

    def _fill(
        self,
        executor: Executor,
        waiting: Iterator[list[ClassSubmission]],
        under_way: dict[Future[Report], list[ClassSubmission]],
    ) -> None:
        """Give the executor enough to do."""
        while len(under_way) < _AHEAD * executor.slots:
            group = next(waiting, None)
            if group is None:
                return
            request = group[0].request(self._hidden, require_isolation=self._require_isolation)
            if request is None:
                self._keep(group, group[0].unreadable())
            else:
                under_way[executor.submit(request)] = group

    def _keep(self, group: list[ClassSubmission], report: Report) -> None:
        """Write the result of a submission and of those identical to it."""
        first = group[0]
        exercise = first.exercise
        if exercise.id not in self._versions:
            self._versions[exercise.id] = versions_of(exercise)
        self._records.require_kept(self.done[-1:])  # at once, not after hours
        for one in group:
            own, same_as = (report, "") if one is first else (one.own_report(report, first), first.entry.student)
            record = replace(one.record(own), versions=self._versions[exercise.id], same_as=same_as)
            self._records.keep(record, render_page(own, one.entry.name or one.entry.student, one.text))
            self.done.append(record)
            self._progress.done(record)


def _result(submission: ClassSubmission, future: Future[Report]) -> Report:
    """The report; where grading itself has failed one that says so, as nothing may end the grading of the others."""
    try:
        return future.result()
    except Exception as problem:  # noqa: BLE001 - of a cluster, of a worker; whatever it is, it is not the student's
        why = f"The grading failed: {problem or type(problem).__name__}"
        return engine.unreadable(submission.exercise, submission.entry.source, why, status="error")


def versions_of(exercise: Exercise) -> dict[str, str]:
    """Fingerprints of the kit and an exercise as they are now: results with the same two were graded by the same rules.

    An exercise's grader may lie in its folder, with all that it uses.
    """
    apart = {exercise.folder / exercise.starter, exercise.folder / exercise_folders.PROOF}
    found = (path for path in exercise.folder.rglob("*") if path.suffix in _SOURCES and path.is_file())
    return {"kit": _kit(), "exercise": _fingerprint(path for path in found if not apart & {path, *path.parents})}


@lru_cache(maxsize=1)
def _kit() -> str:
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
