"""Gradings on the machines of a Dask cluster, each of which needs the course kit of this version."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any

from course_kit.grading.errors import GradingError
from course_kit.grading.pool import Graders, Pool

if TYPE_CHECKING:
    from concurrent.futures import Future

    from course_kit.grading.engine import GradingRequest
    from course_kit.grading.model.report import Report

_PLUGIN = "course-kit"
_CONNECT_S = 10
_CLOSE_S = 5
_RETRIES = 3  # a grading whose machine died is done again elsewhere, so often


class SchedulerLostError(GradingError):
    """The scheduler of a cluster ended or became unreachable while submissions were graded."""


class Cluster(Graders):
    """The workers of a Dask scheduler."""

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
        """See `Graders`; a scheduler that comes back knows nothing of what was under way."""
        if self._client.status != "running":
            raise SchedulerLostError(f"The Dask scheduler at {self._address} has ended or cannot be reached.")

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
            self.pool = Pool(worker.state.nthreads)

        def teardown(self, worker: Any) -> None:
            del worker
            self.pool.close()

    return Grading()
