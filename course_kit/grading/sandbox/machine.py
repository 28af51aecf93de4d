"""What the machine's processors have done, and how much of them and of memory this process may use.

Rests on proc(5) and cgroups(7).
"""

from __future__ import annotations

import math
import os
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

_TICKS = os.sysconf("SC_CLK_TCK")
_IDLE, _WAITING_FOR_DISKS = 3, 4  # columns of /proc/stat
_COLUMNS = 8  # those that follow are counted in the first ones as well
_CGROUPS = Path("/sys/fs/cgroup")
_OWN_GROUPS = Path("/proc/self/cgroup")
_MEMORY = Path("/proc/meminfo")


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
    return min([1.0, *(limit for group in own_groups() if (limit := _limit(group)) > 0.0)])


def free_memory() -> int:
    """Bytes that new programs may take, as the kernel estimates it, or a control group allows it; 0 if unknown."""
    rooms = []
    with suppress(OSError, ValueError, IndexError):
        rooms.append(int(_MEMORY.read_text(encoding="ascii").partition("MemAvailable:")[2].split()[0]) * 1024)
    for group in own_groups():
        with suppress(OSError, ValueError):  # "max"
            bound, taken = (int((group / f"memory.{name}").read_text(encoding="ascii")) for name in ("max", "current"))
            rooms.append(bound - taken)
    return max(0, min(rooms, default=0))


def own_groups() -> list[Path]:
    """The folders of the control group this process is in, and of those around it, as far as they can be seen."""
    with suppress(OSError):
        path = _OWN_GROUPS.read_text(encoding="utf-8").rpartition("0::/")[2].strip()  # of version 2
        return [cgroup for cgroup in (_CGROUPS / path, *(_CGROUPS / path).parents) if cgroup.is_relative_to(_CGROUPS)]
    return []


def _limit(group: Path) -> float:
    """Processors that all processes of a control group get together; infinite without a limit."""
    with suppress(OSError, ValueError, ZeroDivisionError):
        quota, period = (group / "cpu.max").read_text(encoding="utf-8").split()
        return math.inf if quota == "max" else int(quota) / int(period)
    return math.inf
