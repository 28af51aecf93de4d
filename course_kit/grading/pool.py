"""Warm workers, as many as gradings run side by side; whoever grades takes one and gives it back.

One that died is replaced, and its submission is tried once more: a worker that was killed from outside is no fault of
a student's, and a submission that kills workers must not stop a class.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from course_kit.grading import engine
from course_kit.grading.errors import GradingError
from course_kit.grading.workers.worker import Worker, side_by_side

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.engine import GradingRequest
    from course_kit.grading.model.report import Report

_TRIES = 2


class Pool:
    """Workers of one process; safe to use from many threads."""

    def __init__(self, warm: int = 0, graders: Sequence[str] = (), *, awake: int | None = None) -> None:
        """Start `warm` workers ahead of time, with the modules `graders` loaded; more are started when needed."""
        self._idle = side_by_side(warm, graders, awake=awake)[::-1]  # the first to be ready is the first to be taken
        self._lock = threading.Lock()
        self._busy: set[Worker] = set()
        self._closed = False

    def grade(self, request: GradingRequest) -> Report:
        """Grade with a worker that is free; a report comes whatever happens."""
        problem = ""
        for _ in range(_TRIES):
            worker = self._take()
            if worker is None:
                break
            try:
                report = engine.grade_submission(request, worker)
            except Exception as failure:  # noqa: BLE001 - a worker in an unforeseen state must not end a class run
                problem = str(failure) if isinstance(failure, GradingError) else f"The worker failed: {failure!r}."
                self._give_back(worker, usable=False)
            else:
                self._give_back(worker, usable=True)
                return report
        return engine.unreadable(request.exercise, request.shown, problem, status="error")

    def close(self) -> None:
        """End all workers and what they have under way."""
        with self._lock:
            self._closed = True
            workers = [*self._idle, *self._busy]
            self._idle = []
        for worker in workers:
            worker.close()

    def _take(self) -> Worker | None:
        """A worker that is free, or a new one; None once the pool is closed: nobody would end it."""
        with self._lock:
            if self._closed:
                return None
            while self._idle and self._idle[-1].has_ended():  # with the process they share; costs nobody a try
                self._idle.pop().close()
            worker = self._idle.pop() if self._idle else Worker()
            self._busy.add(worker)
            return worker

    def _give_back(self, worker: Worker, *, usable: bool) -> None:
        with self._lock:
            self._busy.discard(worker)
            if usable and not self._closed:
                self._idle.append(worker)
                return
        worker.close()
