"""A clock that does not count the time a loaded machine has taken away."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

_RECENT_S = 0.1
_MOST = 0.8  # however busy the machine: after five times the patience a wait is over


class Recent:
    """A count that may be some moments old, where asking anew costs more than most waits last."""

    def __init__(self, count: Callable[[], float]) -> None:
        self._count = count
        self._value, self._at = 0.0, -_RECENT_S

    def __call__(self) -> float:
        """The count of now."""
        self._value, self._at = self._count(), time.monotonic()
        return self._value

    def lately(self) -> float:
        """The count of now or of a moment ago."""
        return self._value if time.monotonic() - self._at < _RECENT_S else self()


class FairClock:
    """Seconds since its making, minus those in which the submission or the grader was ready to run and was not let.

    The kernel counts that per thread (schedstat, see Documentation/scheduler/sched-stats.rst of Linux). A correct
    submission on a machine with many other programs thus gets the same patience as on an idle one.
    """

    def __init__(self, of_submission: Recent, own: Recent, most: float = _MOST) -> None:
        """Start the clock.

        Args:
            of_submission: seconds its threads have waited for a processor so far; as rarely asked as possible.
            own: the same of the grader's.
            most: the largest part of the time that is taken for lost.
        """
        self._most = most
        self._of_submission, self._own = of_submission, own
        self._began = time.monotonic()
        self._waited = (of_submission.lately(), own.lately())
        self._counted = (0.0, 0.0)  # seconds on the wall and fair ones, when it was counted last

    def wall(self) -> float:
        """Seconds on the wall."""
        return time.monotonic() - self._began

    def past(self, seconds: float) -> bool:
        """Whether `seconds` have gone by, fairly counted.

        Counting takes a look at every thread, so it is done only when they can have gone by: since the last count no
        more fair seconds have passed than seconds on the wall.
        """
        wall, fair = self._counted
        return fair + self.wall() - wall >= seconds and self.fair() >= seconds

    def fair(self) -> float:
        """Seconds, fairly counted."""
        wall = self.wall()
        lost = max(self._of_submission() - self._waited[0], self._own() - self._waited[1])
        fair = wall - min(max(lost, 0.0), self._most * wall)
        self._counted = (wall, fair)
        return fair
