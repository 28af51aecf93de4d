"""A clock that does not count the time a loaded machine has taken away."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

_RECENT_S = 0.25
MOST = 0.8  # however busy the machine: after five times the patience a wait is over


class ProcessorUse(NamedTuple):
    """What some threads have had of the machine's processors so far, in seconds."""

    cpu_s: float = 0.0  # of computing, all of them together
    waited_s: float = 0.0  # in which the one that suffered most was ready to run and others had the processors
    hidden_s: float = 0.0  # of computing that nobody knows of, at most


class MachineState(NamedTuple):
    """How things stand at one moment."""

    submission: ProcessorUse
    grader: ProcessorUse
    busy_s: float | None = None  # seconds the machine's processors have worked for anybody; None where it is not known
    helpers_waited_s: float = 0.0  # of the threads that bring the grader its messages, as in `ProcessorUse`


class CachedState:
    """A state that may be some moments old, where asking anew costs more than most waits last."""

    def __init__(self, look: Callable[[], MachineState]) -> None:
        self._look = look
        self._value: MachineState | None = None
        self._at = 0.0

    def __call__(self) -> MachineState:
        """The state of now."""
        self._value, self._at = self._look(), time.monotonic()
        return self._value

    def recent_state(self) -> MachineState:
        """The state of now or of a moment ago."""
        if self._value is None or time.monotonic() - self._at >= _RECENT_S:
            return self()
        return self._value


class FairClock:
    """Seconds since its making, minus those in which others kept the submission or the grader from running.

    The kernel counts for each thread how long it was ready to run and was not let (schedstat, in sched-stats.rst of
    Linux). Others can have taken no more than they have used of the processors; and at least as much time has gone by
    as a submission has computed, as its threads may stand in each other's way.
    """

    def __init__(
        self, state: CachedState, most: float = MOST, share: float = 1.0, lateness: Callable[[], float] | None = None
    ) -> None:
        self._state, self._most = state, most  # how things stand; the largest part of the time that is taken for lost
        self._share = share  # of one processor, which a single thread gets here when nobody else wants any
        # Seconds by which the grader has noticed late what had come: what it waited before that was not lost.
        self._lateness = lateness
        self._began = time.monotonic()
        self._before = state.recent_state()
        self._counted = (0.0, 0.0)  # seconds on the wall and fair ones, when it was counted last

    def wall_s(self) -> float:
        """Seconds on the wall."""
        return time.monotonic() - self._began

    def has_passed(self, seconds: float) -> bool:
        """Whether `seconds` have gone by, fairly counted: which costs a look at each thread, if they can have."""
        wall, fair = self._counted
        return fair + self.wall_s() - wall >= seconds and self.fair_s() >= seconds

    def fair_s(self) -> float:
        """Seconds, fairly counted."""
        wall = self.wall_s()
        now = self._state()
        late = now.grader.waited_s - self._before.grader.waited_s
        if self._lateness is not None:
            late = max(self._lateness(), now.helpers_waited_s - self._before.helpers_waited_s)
        waited = now.submission.waited_s - self._before.submission.waited_s
        fair = wall - self._lost_s(wall, now, max(waited, late))
        self._counted = (wall, fair)
        return fair

    def latency(self) -> float:
        """Seconds, fairly counted as soon as there are many: of a quick answer nobody counts what others have taken."""
        return self.fair_s() if self.wall_s() > 1.0 else self.wall_s()

    def grader_lost(self) -> float:
        """Seconds in which others have kept the grader from running: as late it may have noticed something."""
        now = self._state()
        return self._lost_s(self.wall_s(), now, now.grader.waited_s - self._before.grader.waited_s)

    def _lost_s(self, wall: float, now: MachineState, waited: float) -> float:
        """How much of the seconds on the wall others have taken away, of those that somebody has waited."""
        before = self._before
        used_s = now.submission.cpu_s - before.submission.cpu_s
        lost = min(waited, wall - used_s / self._share, self._most * wall)
        if now.busy_s is not None and before.busy_s is not None:
            hidden_s = now.submission.hidden_s - before.submission.hidden_s
            own = used_s + hidden_s + now.grader.cpu_s - before.grader.cpu_s
            lost = min(lost, now.busy_s - before.busy_s - own)
        return max(lost, 0.0)
