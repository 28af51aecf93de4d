"""Where the gradings of a class are done: on this machine, or on a Dask cluster; for `run` both are the same.

An executor has `slots`, takes a `GradingRequest` by `submit` and returns a future of its `Report`, as those of
`concurrent.futures` do.
"""

from __future__ import annotations

import logging
import os
import sys
from typing import TYPE_CHECKING, Any, Protocol

from course_kit.classroom.concurrency import GradingQueue
from course_kit.grading.errors import GradingError
from course_kit.grading.sandbox import machine, needs
from course_kit.grading.workers.pool import Pool

if TYPE_CHECKING:
    from collections.abc import Sequence
    from concurrent.futures import Future

    from course_kit.grading.engine import GradingRequest
    from course_kit.grading.model.limits import Limits
    from course_kit.grading.model.report import Report

_WORKERS_PER_CORE = 2  # a grading waits for answers about as long as it computes
_MORE_WHEN_IDLE = 3  # times as many, while submissions that are silent hold workers and leave processors idle
_MORE_THAT_WAIT = 6  # times as many, while processors idle because most gradings wait, as far as there is memory
_EACH = 50 << 20  # bytes of memory that a grading of an ordinary submission takes
_ROOM = 4  # times as much has to be free as they take together: a submission may need more
_PLUGIN = "course-kit"
_CONNECT_S = 10
_CLOSE_S = 5
_RETRIES = 3  # a grading whose machine died is done again elsewhere, so often


class Executor(Protocol):
    """Where gradings are done."""

    @property
    def slots(self) -> int:
        """How many gradings are done side by side."""

    def submit(self, request: GradingRequest) -> Future[Report]:
        """Have a submission graded some time."""

    def require_reachable(self) -> None:
        """See that reports can still come back."""

    def close(self) -> None:
        """Stop; what is under way is given up."""


class SchedulerLostError(GradingError):
    """The scheduler of a cluster has ended, or cannot be reached any more, while submissions were graded."""


class LocalExecutor:
    """Workers on this machine, started ahead of time."""

    def __init__(
        self, workers: int | None = None, graders: Sequence[str] = (), promised: Sequence[Limits] = ()
    ) -> None:
        most = min(map(needs.side_by_side, promised), default=sys.maxsize)
        usual = min(workers or _WORKERS_PER_CORE * len(os.sched_getaffinity(0)), most)
        idle = min(_MORE_WHEN_IDLE * usual, most)
        # Not where somebody has said how many: who does, wants to keep the machine from it.
        waiting = 0 if workers else min(_MORE_THAT_WAIT * usual, most, machine.free_memory() // (_ROOM * _EACH))
        self.slots = max(idle, waiting)
        self._pool = Pool(self.slots, graders, awake=usual)
        self._turns = GradingQueue(self._pool.grade, usual, idle, most_that_wait=waiting)

    def submit(self, request: GradingRequest) -> Future[Report]:
        return self._turns.submit(request)

    def require_reachable(self) -> None:
        """See `Executor`; workers of this machine that end are replaced."""

    def close(self) -> None:
        self._turns.end()
        self._pool.close()
        self._turns.join()


class ClusterExecutor:
    """Workers on the machines of a Dask cluster; each of them needs the course kit of this version."""

    def __init__(self, address: str) -> None:
        try:
            import distributed
        except ImportError as problem:
            raise GradingError(
                'Grading on a cluster needs Dask. Install it with: .venv/bin/python -m pip install -e ".[cluster]"'
            ) from problem
        for name in ("distributed", "distributed.client"):  # what they say with tracebacks, we say
            logging.getLogger(name).setLevel(logging.CRITICAL)
        try:
            self._client = distributed.Client(address, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError, TypeError) as problem:
            raise GradingError(f"There is no Dask scheduler at {address}: {problem}.") from problem
        self._address = address
        self.slots = sum(self._client.nthreads().values())
        if not self.slots:
            self._client.close()
            raise GradingError(f"The Dask scheduler at {address} has no workers yet. Start some, then run this again.")
        self._client.register_plugin(_plugin())
        self._futures: Any = self._client.get_executor(retries=_RETRIES, pure=False)

    def submit(self, request: GradingRequest) -> Future[Report]:
        self.require_reachable()
        future: Future[Report] = self._futures.submit(grade_on_cluster, request)
        return future

    def require_reachable(self) -> None:
        """See `Executor`; a scheduler that comes back knows nothing of what was under way."""
        if self._client.status != "running":
            raise SchedulerLostError(f"The Dask scheduler at {self._address} has ended or cannot be reached any more.")

    def close(self) -> None:
        self._futures.shutdown(wait=False)  # cancels what has not come back
        self._client.close(timeout=_CLOSE_S)


def grade_on_cluster(request: GradingRequest) -> Report:
    """What a Dask worker does with a request: grade it with a warm worker that its process keeps."""
    import distributed

    pool: Pool = distributed.get_worker().plugins[_PLUGIN].pool
    return pool.grade(request)


def _plugin() -> Any:
    import distributed

    class Grading(distributed.WorkerPlugin):  # type: ignore[misc]  # Dask has no types
        """Gives each Dask worker process a pool of warm graders, and ends them with it."""

        name = _PLUGIN
        idempotent = True

        def setup(self, worker: Any) -> None:
            self.pool = Pool(warm=worker.state.nthreads)

        def teardown(self, worker: Any) -> None:
            del worker
            self.pool.close()

    return Grading()
