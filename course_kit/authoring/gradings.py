"""Many gradings side by side, each by one of a few warm workers."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING

from course_kit import grading

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from concurrent.futures import Future
    from types import TracebackType

    from typing_extensions import Self

    from course_kit.authoring.corpus import ProofSubmission

# A grading mostly waits: for the robot, for the next status line, for what does not come.
WORKERS_A_PROCESSOR = 3
_BUSY = "import os\nparent = os.getppid()\nwhile os.getppid() == parent: pass"


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0))


class Gradings:
    """The workers, and the threads that each wait for one of them. Use it in a `with` statement."""

    def __init__(self, exercises: Path, workers: int = 0, others: Mapping[str, Path] | None = None) -> None:
        """Start the workers."""
        self._exercises, self._others = exercises, others or {}
        count = workers or WORKERS_A_PROCESSOR * processors()
        self._folder = tempfile.TemporaryDirectory(prefix="course-kit-slips-")
        self._ending = False
        self._all: list[grading.Worker] = []
        self._free: SimpleQueue[grading.Worker] = SimpleQueue()
        for _ in range(count):
            self._add_worker()
        self._threads = ThreadPoolExecutor(count)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ending = True
        if problem is not None:  # nobody waits for the rest any more
            self._threads.shutdown(wait=False, cancel_futures=True)
            self._close_workers()
        self._threads.shutdown(cancel_futures=True)
        self._close_workers()
        self._folder.cleanup()

    def begin(self, submission: ProofSubmission, seed: int | None) -> Future[grading.Report]:
        """Have one graded as soon as a worker is free; with `seed` None by the exercise's own."""
        return self._threads.submit(self._grade, submission, seed)

    def _grade(self, submission: ProofSubmission, seed: int | None) -> grading.Report:
        path = submission.path
        if submission.changes:
            path = Path(self._folder.name) / submission.exercise / f"{submission.name}.py"
            path.parent.mkdir(exist_ok=True)
            path.write_text(submission.text(), encoding="utf-8")
        folder = self._others.get(submission.exercise, self._exercises)
        worker = self._free.get()
        try:
            report = grading.grade(submission.exercise, path, seed=seed, worker=worker, exercises=folder)
        except grading.GradingError:
            if not self._ending:  # it has ended, or hangs; the others go on
                worker.close()
                self._add_worker()
            raise
        self._free.put(worker)
        return report

    def _add_worker(self) -> None:
        worker = grading.Worker()
        self._all.append(worker)
        self._free.put(worker)

    def _close_workers(self) -> None:
        for worker in self._all:
            worker.close()


@contextmanager
def load(count: int) -> Iterator[list[int]]:
    """Keep `count` processors busy; yields the ids of the processes that do, which end with this one at the latest."""
    busy = [subprocess.Popen([sys.executable, "-S", "-c", _BUSY]) for _ in range(count)]
    try:
        yield [process.pid for process in busy]
    finally:
        for process in busy:
            process.kill()
            process.wait()
