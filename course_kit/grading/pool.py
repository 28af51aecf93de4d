"""Graders side by side: warm workers of this machine, and the one loop that gives graders enough to do.

A worker that died is replaced, and its submission is tried once more: a worker that was killed from outside is no fault
of a student's, and a submission that kills workers must not stop a class.
"""

from __future__ import annotations

import os
import threading
from abc import abstractmethod
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, TypeVar

from course_kit.grading import engine
from course_kit.grading.errors import GradingError
from course_kit.grading.model.report import Report
from course_kit.grading.sandbox import machine, needs
from course_kit.grading.workers.worker import Worker, start_workers
from course_kit.process import Closable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from concurrent.futures import Future

    from course_kit.grading.engine import GradingRequest
    from course_kit.grading.model.exercise import Exercise

_TRIES = 2
_PER_CORE = 6  # a grading mostly waits: for answers, and for a program that is silent or asleep
_EACH = 50 << 20  # bytes of memory that a grading of an ordinary submission takes
_ROOM = 4  # times as much has to be free as they take together: a submission may need more
_AHEAD = 2  # requests given to graders for each of their slots: none idles, and few are lost
_LISTEN_S = 0.5  # how often a wait for reports looks at who wants to stop
_AT_ONCE = 2  # requests to stop
Thing = TypeVar("Thing")


class Graders(Closable):
    """Where gradings are done: a `Pool` of this machine, or a cluster."""

    slots: int  # how many gradings are done side by side

    @abstractmethod
    def submit(self, request: GradingRequest) -> Future[Report]:
        """Have a submission graded some time."""

    def require_reachable(self) -> None:  # workers of this machine that end are replaced
        """See that reports can still come back."""


class Pool(Graders):
    """Workers of this machine; safe to use from many threads."""

    def __init__(self, slots: int, exercises: Sequence[Exercise] = ()) -> None:
        """Start workers for so many gradings at a time."""
        self.slots = slots
        self._idle = start_workers(slots, exercises)
        self._workers = [*self._idle]  # all there have been
        self._lock = threading.Lock()
        self._closed = False
        self._threads = ThreadPoolExecutor(slots, thread_name_prefix="grading")

    def submit(self, request: GradingRequest) -> Future[Report]:
        """See `Graders`."""
        return self._threads.submit(self.grade, request)

    def grade(self, request: GradingRequest) -> Report:
        """Grade with a worker that is free; a report comes whatever happens."""
        problem = ""
        for _ in range(_TRIES):
            worker = self._take()
            if worker is None:
                break
            try:
                return engine.grade_submission(request, worker)
            except Exception as failure:  # noqa: BLE001 - a worker in an unforeseen state must not end a class run
                problem = str(failure) if isinstance(failure, GradingError) else f"The worker failed: {failure!r}."
                worker.close()
            finally:
                self._idle.append(worker)
        return engine.report_unreadable(request.exercise, request.shown, problem, status="error")

    def close(self) -> None:
        """End all workers and what they have under way."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        with self._lock:
            self._closed = True
        for worker in self._workers:
            worker.close()
        self._threads.shutdown()

    def _take(self) -> Worker | None:
        """A worker that is free, or a new one; None once the pool is closed: nobody would end it."""
        with self._lock:
            if self._closed:
                return None
            while self._idle:
                worker = self._idle.pop()
                if not worker.has_ended():  # perhaps with the process they share, which costs nobody a try
                    return worker
                worker.close()
            self._workers.append(Worker())
            return self._workers[-1]


def start_pool(exercises: Sequence[Exercise], workers: int | None = None) -> Pool:
    """A pool for some exercises: of so many workers, or of those for which there is memory; of no more than may run."""
    if workers is not None and workers < 1:
        raise GradingError(f"--workers is {workers}, but at least one grading has to be done at a time.")
    memory = machine.free_memory() // (_ROOM * _EACH)
    wanted = workers or max(1, min(_PER_CORE * len(os.sched_getaffinity(0)), memory))
    return Pool(min([wanted, *(needs.count_side_by_side(exercise.limits) for exercise in exercises)]), exercises)


def grade_all(
    graders: Graders,
    requests: Iterable[tuple[Thing, GradingRequest | Report]],
    stops: Callable[[], int] = lambda: 0,
    listen: Callable[[int], None] = lambda _: None,
) -> Iterator[tuple[Thing, Report]]:
    """Grade; each report comes out with its thing as soon as it is there, in whatever order; a report as it is."""
    waiting = iter(requests)
    under_way: dict[Future[Report], tuple[Thing, GradingRequest]] = {}
    while stops() < _AT_ONCE:
        if stops():
            waiting = iter(())
            for future in [task for task in under_way if task.cancel()]:
                del under_way[future]
        while len(under_way) < _AHEAD * graders.slots and (following := next(waiting, None)):
            thing, request = following
            if isinstance(request, Report):
                yield thing, request
            else:
                under_way[graders.submit(request)] = (thing, request)
        if not under_way:
            return
        listen(len(under_way))
        finished, _ = wait(under_way, _LISTEN_S, FIRST_COMPLETED)
        for future in [task for task in under_way if task in finished]:  # in the order they were given out
            thing, request = under_way.pop(future)
            report = _result(request, future)
            if report.status == "error":
                graders.require_reachable()  # an error that comes of that is of no submission
            yield thing, report
        graders.require_reachable()


def _result(request: GradingRequest, future: Future[Report]) -> Report:
    """The report; where grading itself has failed one that says so, as nothing may end the grading of the others."""
    try:
        return future.result()
    except Exception as problem:  # noqa: BLE001 - of a cluster, of a worker; whatever it is, it is not the student's
        why = f"The grading failed: {problem or type(problem).__name__}"
        return engine.report_unreadable(request.exercise, request.shown, why, status="error")
