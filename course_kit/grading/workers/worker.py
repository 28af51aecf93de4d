"""A warm process that grades one submission after another.

Importing rclpy and loading a service type takes ten times as long as checking a submission, so a worker does it
once and forks. Several workers grade side by side. This is the handle in the trusted parent; the process itself is
`worker_process`, and how it is started is in `warm_process`.
"""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, cast

from course_kit.grading.errors import GradingError
from course_kit.grading.model import limits
from course_kit.grading.model.job import Isolation
from course_kit.grading.sandbox.channel import Channel, ChannelClosedError
from course_kit.grading.workers.warm_process import WarmProcess, variables_of
from course_kit.process import Closable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.model.job import GradingOutcome, Job
    from course_kit.grading.model.plain_data import Record

_START_S = 60.0  # importing everything from a cold disk on a loaded machine
_GRACE_S = 60.0  # beyond the queue and the wall time; a worker that is later than that hangs, by a fault of ours


class Worker(Closable):
    """A worker process. Start many ahead of time; each takes one job at a time, from one thread at a time."""

    def __init__(
        self,
        *,
        whole_environment: bool = False,
        own_graph: bool = True,
        at: tuple[WarmProcess, Channel] | None = None,
    ) -> None:
        """Start the process; it gets ready while the caller goes on."""
        alone = at is None
        if at is None:
            process = WarmProcess(1, variables_of(whole=whole_environment, own_graph=own_graph))
            at = (process, process.channels[0])
        self._process, self._channel = at
        self._is_asleep = True
        self._closing = False
        self._greeting: Record | None = None
        if alone:
            self.wake()

    @property
    def process_id(self) -> int:
        """Of the worker process."""
        self.ready()
        return int((self._greeting or {})["process"])

    def wake(self) -> None:
        """Have it get ready, if it does not yet."""
        if self._is_asleep:
            self._is_asleep = False
            with suppress(ChannelClosedError):  # whoever uses it is told
                self._channel.send({})

    def ready(self) -> Isolation:
        """Wait until it can take a job; returns the isolation it has found."""
        if self._greeting is None:
            try:
                self.wake()
                self._greeting = self._channel.receive(_START_S)
            except (ChannelClosedError, TimeoutError) as problem:
                raise GradingError(f"The grader could not start. {self._last_words()}") from problem
        if problem_text := self._greeting.get("problem"):
            raise GradingError(str(problem_text))
        return Isolation(**self._greeting["isolation"])

    def grade(self, job: Job) -> GradingOutcome:
        """Grade one submission; returns the outcome as the supervisor describes it."""
        self.ready()
        try:
            self._channel.send({"job": job})
            outcome = self._channel.receive(limits.QUEUE_S + job.limits.wall_s + _GRACE_S)
        except (ChannelClosedError, TimeoutError) as problem:
            raise GradingError(f"The grader ended while it was grading. {self._last_words()}") from problem
        if "results" not in outcome:  # its last words
            raise GradingError(str(outcome.get("problem", "The grader ended while it was grading.")))
        return cast("GradingOutcome", outcome)

    def has_ended(self) -> bool:
        """Whether its process has gone, for one that is not at work."""
        return self._process.has_ended() or self._channel.is_closed()

    def close(self) -> None:
        """End the process and everything it has started; one of several ends with the last of them at the latest."""
        first, self._closing = not self._closing, True
        self._channel.hang_up()  # it notices, ends what it has under way, and stops
        if first:
            self._process.leave()

    def _last_words(self) -> str:
        """What the process has printed, when it has ended."""
        how = self._process.give_up((self._greeting or {}).get("process"))
        return "It was closed meanwhile." if self._closing else how


def side_by_side(number: int, graders: Sequence[str] = (), *, awake: int | None = None) -> list[Worker]:
    """Start several workers that share the cost of getting warm."""
    if number == 0:
        return []
    process = WarmProcess(number, variables_of(whole=False, own_graph=True), graders)
    workers = [Worker(at=(process, channel)) for channel in process.channels]
    for worker in workers[:awake]:
        worker.wake()
    return workers
