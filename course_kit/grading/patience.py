"""A clock that does not count the time a loaded machine has taken away."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from course_kit.grading import processes

if TYPE_CHECKING:
    from collections.abc import Callable

_RECENT_S = 0.1  # how old the count may be from which a clock starts: counting anew costs more than most waits last
_MOST = 0.8  # however busy the machine: after five times the patience a wait is over


class FairClock:
    """Seconds since its making, minus those in which the submission or the grader was ready to run and was not let.

    The kernel counts that per thread (schedstat, see Documentation/scheduler/sched-stats.rst of Linux). A correct
    submission on a machine with many other programs thus gets the same patience as on an idle one.
    """

    def __init__(
        self, waited_by_submission: Callable[[float], float], own_waiting: Callable[[], float] = processes.own_waiting
    ) -> None:
        """Start the clock.

        Args:
            waited_by_submission: seconds its threads have waited for a processor so far; given how many seconds old
                the count may be, and asked as rarely as possible.
            own_waiting: the same of the grader. What it counts by itself includes the waiting of a grader that only
                looks whether something has come yet; who measures how long things took, knows better.
        """
        self._of_submission, self._own = waited_by_submission, own_waiting
        self._began = time.monotonic()
        self._waited = (waited_by_submission(_RECENT_S), own_waiting())

    def wall(self) -> float:
        """Seconds on the wall."""
        return time.monotonic() - self._began

    def past(self, seconds: float) -> bool:
        """Whether `seconds` have gone by, fairly counted."""
        return self.wall() >= seconds and self.fair() >= seconds

    def fair(self) -> float:
        """Seconds, fairly counted."""
        wall = self.wall()
        lost = max(self._of_submission(0.0) - self._waited[0], self._own() - self._waited[1])
        return wall - min(max(lost, 0.0), _MOST * wall)
