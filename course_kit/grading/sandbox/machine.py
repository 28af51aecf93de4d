"""What the machine has: what its processors have done, and for whom; how much may be used; the memory that is taken.

Rests on proc(5), where the scheduler counts who was kept from running (/proc/*/schedstat), and on cgroups(7). What was
sent and nobody has received lies in the kernel, and in no process (socket(7)): where a submission has a network to
itself, each socket counts with as much as it can hold.
"""

from __future__ import annotations

import os
import random
import time
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.process import tree

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

_TICKS = os.sysconf("SC_CLK_TCK")
_PROC = "/proc"
_NS = 1e9
_COMPUTED = slice(11, 13)  # columns of /proc/PID/stat after the name
_IDLE, _WAITING_FOR_DISKS = 3, 4  # columns of /proc/stat
_COLUMNS = 8  # those that follow are counted in the first ones as well
_CGROUPS = Path("/sys/fs/cgroup")
_OWN_GROUPS = Path("/proc/self/cgroup")
_MEMORY = Path("/proc/meminfo")
_BESIDE_PAGES = ("\nVmPTE:", "\nVmSwap:")  # the tables of pages, and what was swapped out
BUFFER = 212992  # bytes that a socket can hold in one direction (net.core.rmem_default and wmem_default of Linux)


def processors_worked() -> float:
    """Seconds that all processors this process may run on have worked since the machine was started; 0 if unknown."""
    own = {f"cpu{number}" for number in os.sched_getaffinity(0)}
    ticks = 0
    with suppress(OSError, ValueError, IndexError), open("/proc/stat", encoding="utf-8") as file:  # noqa: PTH123 - hot
        for line in file:
            name, *columns = line.split()
            if name in own:
                times = [int(column) for column in columns[:_COLUMNS]]
                ticks += sum(times) - times[_IDLE] - times[_WAITING_FOR_DISKS]
    return ticks / _TICKS


@lru_cache(maxsize=1)
def processor_share() -> float:
    """How much of one processor a single thread can get here: 1, or less in a container that is held to less."""
    return min([1.0, *(quota / period for quota, period in read_groups("cpu.max") if quota and period)])


def free_memory() -> int:
    """Bytes that new programs may take, as the kernel estimates it, or a control group allows it; 0 if unknown."""
    in_groups = (bound - taken for bound, taken in read_groups("memory.max", "memory.current"))
    return max(0, min([_read_number(_MEMORY, "MemAvailable:") * 1024, *in_groups]))


def read_groups(*names: str) -> Iterator[tuple[int, int]]:
    """Two numbers of files of the control group this process is in, and of those around it; none where it is "max"."""
    with suppress(OSError):
        own = _CGROUPS / _OWN_GROUPS.read_text(encoding="utf-8").rpartition("0::/")[2].strip()  # of version 2
        for group in (folder for folder in (own, *own.parents) if folder.is_relative_to(_CGROUPS)):
            with suppress(OSError, ValueError):
                texts = [(group / name).read_text(encoding="ascii") for name in names]
                first, second = map(int, " ".join(texts).split())
                yield first, second


def measure_memory(process_ids: Sequence[int], patience_s: float) -> int:
    """Bytes of memory these processes take from the machine: pages that forks share are counted once."""
    deadline = time.monotonic() + patience_s
    total = 0
    for process_id in random.sample(process_ids, len(process_ids)):  # no process is always last
        with suppress(OSError):  # one that hides the figures counts with all that is resident
            folder = Path(f"/proc/{tree.speaking_task(process_id)}")
            shared = _read_number(folder / "smaps_rollup", "\nPss:", unknown=-1)
            total += shared * 1024 if shared >= 0 else tree.measure_usage([process_id]).memory
            total += sum(_read_number(folder / "status", name) * 1024 for name in _BESIDE_PAGES)
        if time.monotonic() > deadline:
            break
    return total


def count_oom_kills() -> int:
    """How many processes this machine has killed because its memory was used up, since it was started; 0 if unknown."""
    return _read_number(Path("/proc/vmstat"), "oom_kill ")


def somebody_waited() -> float:
    """Seconds in which anybody on this machine was ready to run and got no processor (psi.rst); 0 if unknown."""
    return _read_number(Path("/proc/pressure/cpu"), "total=") / 1e6


def _read_number(path: Path, words: str = "", unknown: int = 0) -> int:
    """The number behind these words in a file of the kernel's."""
    with suppress(OSError, ValueError, IndexError):
        text = path.read_text(encoding="ascii", errors="replace")
        return int(text[text.index(words) + len(words) :].split()[0])
    return unknown


def bytes_of_sockets() -> int:
    """Bytes that all sockets of this network namespace can hold, closed ones that are not empty, too."""
    return 2 * BUFFER * _read_number(Path("/proc/net/sockstat"), "sockets: used ")


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
