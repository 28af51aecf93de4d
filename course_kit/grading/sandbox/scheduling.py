"""Who was kept from running, and by whom, as the kernel's scheduler counts it (/proc/*/schedstat, proc(5))."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_PROC = "/proc"
_TICKS = os.sysconf("SC_CLK_TCK")
_NS = 1e9
_COMPUTED = slice(11, 13)  # columns of /proc/PID/stat after the name


class _Times(NamedTuple):
    """Seconds a thread has computed, and seconds it was ready to run and got no processor."""

    computed: float
    waited: float


def own_waiting() -> tuple[float, float]:
    """Seconds the thread of this process that suffered most was ready to run and got no processor; and its helpers."""
    with suppress(OSError):
        own = os.path.basename(os.readlink(f"{_PROC}/self"))  # noqa: PTH115, PTH119 - hot
        waited = {name: times.waited for name, times in _threads(int(own)).items()}
        first = waited.pop(own, 0.0)
        helpers = max(waited.values(), default=0.0)
        return max(first, helpers), helpers
    return 0.0, 0.0


class WaitTime:
    """Adds up for how long others have kept a program from running, from look to look.

    Between two looks that is the time of the thread that has waited longest, minus what everything else of the program
    has computed meanwhile: while that had a processor, the waiting was the program's own doing.

    Children that nobody looks at are taken to have had all processors while there are some: the `hidden_s`.
    """

    def __init__(
        self, program: int, *, with_children: bool, clock: Callable[[], float] = time.monotonic, processors: int = 0
    ) -> None:
        self.seconds = self.hidden_s = 0.0
        self._clock, self._processors = clock, processors or len(os.sched_getaffinity(0))
        self._program, self._with_children = program, with_children
        self._threads: dict[str, _Times] = {}
        self._ended = 0.0  # seconds that threads of the program have computed which have ended
        self._had_children = False
        self._tasks, self._last_task, self._noticed_at = 0, 0, clock()
        self._hidden_before = 0.0  # at the last look

    def notice(self, process_ids: Sequence[int], tasks: int) -> None:
        """Take in whether something computes that is not looked at, as often as possible."""
        before, self._tasks = self._tasks, tasks
        last, self._last_task = self._last_task, last_task()
        since, self._noticed_at = self._noticed_at, self._clock()
        has_children = len(process_ids) > 1
        self._had_children |= has_children
        unseen = self._last_task - last - max(tasks - before, 0) if last else 0
        if (has_children and not self._with_children) or (self._had_children and unseen > 0):
            self.hidden_s += self._processors * (self._noticed_at - since)

    def look(self, process_ids: Sequence[int], tasks: int) -> float:
        """Look at the program, and return the seconds so far; for the arguments see `notice`."""
        self.notice(process_ids, tasks)
        before = self._threads
        watched = process_ids if self._with_children else [self._program]
        self._threads = {name: times for process in watched for name, times in _threads(process).items()}
        computed, waited = {}, {}
        for name, times in self._threads.items():
            earlier = before.get(name, _Times(0.0, 0.0))
            computed[name], waited[name] = times.computed - earlier.computed, times.waited - earlier.waited
        hidden, self._hidden_before = self.hidden_s - self._hidden_before, self.hidden_s
        everything = sum(computed.values()) + self._computed_by_ended_threads() + hidden
        longest = max((waited[name] - (everything - computed[name]) for name in waited), default=0.0)
        self.seconds += max(longest, 0.0)
        return self.seconds

    def _computed_by_ended_threads(self) -> float:
        """Seconds of threads of the program that have ended since the last look."""
        living = sum(thread.computed for thread in self._threads.values())
        before, self._ended = self._ended, max(self._ended, _cpu_s(self._program) - living)  # coarse: it never falls
        return self._ended - before


def last_task() -> int:
    """The number of the task that was started last in this PID namespace; 0 where others start some, too."""
    with suppress(OSError, ValueError, IndexError):
        if os.readlink(f"{_PROC}/self") == "1":  # noqa: PTH115 - hot
            with open(f"{_PROC}/loadavg", encoding="utf-8") as file:  # noqa: PTH123 - hot
                return int(file.read().split()[4])
    return 0


def _threads(process_id: int) -> dict[str, _Times]:
    """The times of each thread of a process, by its number."""
    folder, found = f"{_PROC}/{process_id}/task", {}
    with suppress(OSError):
        for name in os.listdir(folder):  # noqa: PTH208 - hot
            with suppress(OSError, ValueError), open(f"{folder}/{name}/schedstat", encoding="utf-8") as file:  # noqa: PTH123
                computed, waited, _ = file.read().split()
                found[name] = _Times(int(computed) / _NS, int(waited) / _NS)
    return found


def _cpu_s(process_id: int) -> float:
    """Seconds that a process has computed; the second column, its name, may hold anything."""
    with suppress(OSError, ValueError), open(f"{_PROC}/{process_id}/stat", encoding="utf-8", errors="replace") as file:  # noqa: PTH123 - hot
        return sum(map(int, file.read().rpartition(")")[2].split()[_COMPUTED])) / _TICKS
    return 0.0
