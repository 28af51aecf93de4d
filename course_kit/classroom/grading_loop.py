"""Has submissions graded by an executor, and keeps each result the moment it is there."""

from __future__ import annotations

from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from course_kit.classroom import versions
from course_kit.grading import engine
from course_kit.grading.render.html import render_page

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from concurrent.futures import Future

    from course_kit.classroom.executors import Executor
    from course_kit.classroom.records import Record, Records
    from course_kit.classroom.submissions import Handed
    from course_kit.grading.report import Report

_AHEAD = 2  # tasks given to an executor for each of its slots: none idles, and few are lost
_LISTEN_S = 0.5  # how often a wait for results looks at the clock and at who wants to stop
_AT_ONCE = 2  # requests to stop


class Watcher(Protocol):
    """Told how a run goes."""

    def begin(self, total: int, ready: Sequence[Record]) -> None:
        """So many submissions, and the results that are there already."""

    def done(self, record: Record) -> None:
        """One more has its result."""

    def tick(self) -> None:
        """Some time has passed."""

    def stopping(self, under_way: int) -> None:
        """Ctrl-C: nothing new is begun, so many are finished."""


class GradingLoop:
    """Gives an executor enough to do, until all is done or somebody has asked to stop."""

    def __init__(
        self,
        records: Records,
        watcher: Watcher,
        stops: Callable[[], int],
        hidden: tuple[str, ...],
        *,
        require_isolation: bool = False,
    ) -> None:
        self._records = records
        self._watcher = watcher
        self._stops = stops
        self._hidden = hidden
        self._require_isolation = require_isolation
        self._versions: dict[str, dict[str, str]] = {}
        self.done: list[Record] = []

    def run(self, groups: Sequence[list[Handed]], executor: Executor) -> None:
        """Grade each group once; those in one are identical. What has its result stands in `done`."""
        waiting = iter(groups)
        under_way: dict[Future[Report], list[Handed]] = {}
        stopping = False
        while self._stops() < _AT_ONCE:
            if self._stops() and not stopping:
                stopping = True
                for future in [future for future in under_way if future.cancel()]:
                    del under_way[future]
                self._watcher.stopping(len(under_way))
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
            self._watcher.tick()

    def _fill(
        self,
        executor: Executor,
        waiting: Iterator[list[Handed]],
        under_way: dict[Future[Report], list[Handed]],
    ) -> None:
        """Give the executor enough to do."""
        while len(under_way) < _AHEAD * executor.slots:
            group = next(waiting, None)
            if group is None:
                return
            task = group[0].task(self._hidden, require_isolation=self._require_isolation)
            if task is None:
                self._keep(group, group[0].unreadable())
            else:
                under_way[executor.submit(task)] = group

    def _keep(self, group: list[Handed], report: Report) -> None:
        """Write the result of a submission and of those identical to it."""
        first = group[0]
        exercise = first.exercise
        if exercise.id not in self._versions:
            self._versions[exercise.id] = versions.of(exercise)
        self._records.require_kept(self.done[-1:])  # at once, not after hours
        for one in group:
            own, same_as = (report, "") if one is first else (one.own_report(report, first), first.entry.student)
            record = replace(one.record(own), versions=self._versions[exercise.id], same_as=same_as)
            self._records.keep(record, render_page(own, one.entry.name or one.entry.student, one.text))
            self.done.append(record)
            self._watcher.done(record)


def _result(submission: Handed, future: Future[Report]) -> Report:
    """The report; where grading itself has failed one that says so, as nothing may end the grading of the others."""
    try:
        return future.result()
    except Exception as problem:  # noqa: BLE001 - of a cluster, of a worker; whatever it is, it is not the student's
        why = f"The grading failed: {problem or type(problem).__name__}"
        return engine.unreadable(submission.exercise, submission.entry.source, why, status="error")
