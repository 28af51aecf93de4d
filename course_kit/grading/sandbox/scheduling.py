"""Who was kept from running, and by whom, as the kernel's scheduler counts it (/proc/*/schedstat, proc(5))."""

from __future__ import annotations

import os
import resource
import time
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

_PROC = "/proc"
_TICKS = os.sysconf("SC_CLK_TCK")
_NS = 1e9
_OWN, _OF_CHILDREN = slice(11, 13), slice(13, 15)  # columns of /proc/PID/stat after the name: times of computing


class _Times(NamedTuple):
    """Seconds a thread has computed, and seconds it was ready to run and got no processor."""

    computed: float
    waited: float


def own_waiting(*, helpers_only: bool = False) -> float:
    """Seconds the thread of this process that suffered most was ready to run and got no processor."""
    with suppress(OSError):
        own = os.path.basename(os.readlink(f"{_PROC}/self"))  # noqa: PTH115, PTH119 - hot
        threads = _threads(int(own))
        return max((times.waited for name, times in threads.items() if not helpers_only or name != own), default=0.0)
    return 0.0


class Waiting:
    """Adds up for how long others have kept a program from running, from look to look.

    Between two looks that is the time of the thread that has waited longest, minus what everything else of the program
    has computed meanwhile: while that had a processor, the waiting was the program's own doing. Its children are
    counted as what keeps it waiting, and not as what waits: the node is in the program itself.

    What children compute that come and go between two looks, nobody need ever be told (SIGCHLD may be ignored). So as
    many as there were of them are taken to have had a processor each for all the time: these are the `hidden_s`.
    """

    def __init__(
        self, program: int, *, with_children: bool, clock: Callable[[], float] = time.monotonic, processors: int = 0
    ) -> None:
        self.seconds = self.hidden_s = 0.0
        self._clock, self._processors = clock, processors or len(os.sched_getaffinity(0))
        self._program, self._with_children = program, with_children
        self._threads: dict[str, _Times] = {}
        self._children: dict[int, float] = {}  # seconds of computing, also of those that have ended
        self._reaped = _reaped()  # of processes that are none of the program's
        self._ended = 0.0  # seconds of threads and children that have ended, as far as the kernel adds them up
        self._elsewhere = 0.0  # the last two together, at the last look
        self._has_children = False
        self._tasks, self._last_task, self._noticed_at = 0, 0, clock()
        self._hidden_before = 0.0  # at the last look

    def notice(self, process_ids: Sequence[int], tasks: int) -> None:
        """Take in what children have computed, as often as possible: of one that has ended nobody else may know."""
        self._has_children |= len(process_ids) > 1
        if not self._has_children:
            return
        if not self._with_children:  # else they are looked at thread by thread
            for child in process_ids:
                if child != self._program:
                    computed = sum(_columns(child, _OWN)) / _TICKS
                    self._children[child] = max(computed, self._children.get(child, 0.0))
        before, self._tasks = self._tasks, tasks
        last, self._last_task = self._last_task, last_task()
        since, self._noticed_at = self._noticed_at, self._clock()
        if last and (unseen := self._last_task - last - max(tasks - before, 0)) > 0:
            self.hidden_s += min(unseen, self._processors) * (self._noticed_at - since)

    def look(self, process_ids: Sequence[int], tasks: int) -> float:
        """Look at the program, and return the seconds so far; for the arguments see `notice`."""
        self.notice(process_ids, tasks)
        before = self._threads
        watched = process_ids if self._with_children else [self._program]
        self._threads = {name: times for one in watched for name, times in _threads(one).items()}
        computed, waited = {}, {}
        for name, times in self._threads.items():
            earlier = before.get(name, _Times(0.0, 0.0))
            computed[name], waited[name] = times.computed - earlier.computed, times.waited - earlier.waited
        hidden, self._hidden_before = self.hidden_s - self._hidden_before, self.hidden_s
        everything = sum(computed.values()) + self._computed_elsewhere() + hidden
        longest = max((waited[name] - (everything - computed[name]) for name in waited), default=0.0)
        self.seconds += max(longest, 0.0)
        return self.seconds

    def _computed_elsewhere(self) -> float:
        """Seconds that children, and threads and children that have ended, have computed since the last look."""
        ended = sum(_columns(self._program, _OF_CHILDREN)) / _TICKS + _reaped() - self._reaped
        if not self._with_children:
            living = sum(one.computed for one in self._threads.values())
            ended += max(sum(_columns(self._program, _OWN)) / _TICKS - living, 0.0)
        self._ended = max(self._ended, ended)  # coarse as it is counted, it never falls
        before, self._elsewhere = self._elsewhere, sum(self._children.values()) + self._ended
        return self._elsewhere - before


def _reaped() -> float:
    """Seconds that children of this process have computed, which have ended and were waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def last_task() -> int:
    """The number of the task that was started last in this PID namespace; 0 where others start some, too."""
    with suppress(OSError, ValueError, IndexError):
        if os.readlink(f"{_PROC}/self") == "1":  # noqa: PTH115 - hot
            with open(f"{_PROC}/loadavg", encoding="utf-8") as file:  # noqa: PTH123 - hot
                return int(file.read().split()[4])
    return 0


def _threads(process_id: int) -> dict[str, _Times]:
    """The times of each thread of a process, by its number."""
    return dict(_each_thread(process_id))


def _each_thread(process_id: int) -> Iterator[tuple[str, _Times]]:
    folder = f"{_PROC}/{process_id}/task"
    with suppress(OSError):
        for name in os.listdir(folder):  # noqa: PTH208 - hot
            with suppress(OSError, ValueError), open(f"{folder}/{name}/schedstat", encoding="utf-8") as file:  # noqa: PTH123
                computed, waited, _ = file.read().split()
                yield name, _Times(int(computed) / _NS, int(waited) / _NS)


def _columns(process_id: int, columns: slice) -> list[int]:
    """Columns of /proc/PID/stat from the third, the state, on: the second, the name, may hold anything."""
    try:
        with open(f"{_PROC}/{process_id}/stat", encoding="utf-8", errors="replace") as file:  # noqa: PTH123 - hot
            return [int(value) for value in file.read().rpartition(")")[2].split()[columns]]
    except (OSError, ValueError):  # it has ended
        return []
