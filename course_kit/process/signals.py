"""How a process is brought to its end: by SIGINT as with Ctrl-C, by SIGTERM, and at last by SIGKILL."""

from __future__ import annotations

import math
import time
from signal import SIGINT, SIGKILL, SIGTERM, Signals


class Ladder:
    """The signals that one process gets, one after the other, and how long it has to obey each."""

    def __init__(self, interrupt_s: float, terminate_s: float, kill_s: float) -> None:
        """Begin at the bottom."""
        self._left = [(SIGINT, interrupt_s), (SIGTERM, terminate_s), (SIGKILL, kill_s)]
        self.climbed: list[tuple[Signals, float]] = []
        self._next_at = math.inf

    @property
    def at_top(self) -> bool:
        """Whether no signal is left."""
        return not self._left

    def climb(self) -> tuple[Signals, float]:
        """The next signal, for the caller to send now, and the seconds that the process has from now on."""
        self.climbed.append(self._left.pop(0))
        self._next_at = time.monotonic() + self.climbed[-1][1] if self._left else math.inf
        return self.climbed[-1]

    def pause_s(self) -> float:
        """Seconds until it is time for the next signal; infinite before the first and after the last."""
        return max(0.0, self._next_at - time.monotonic())
