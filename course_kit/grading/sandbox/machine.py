"""What the machine's processors have done, and how much of them and of memory this process may use.

Rests on proc(5) and cgroups(7).
"""

from __future__ import annotations

import math
import os
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

_TICKS = os.sysconf("SC_CLK_TCK")
_IDLE, _WAITING_FOR_DISKS = 3, 4  # columns of /proc/stat
_COLUMNS = 8  # those that follow are counted in the first ones as well
_CGROUPS = Path("/sys/fs/cgroup")
_OWN_GROUPS = Path("/proc/self/cgroup")
_MEMORY = Path("/proc/meminfo")
_OF_MEMORY = (("memory.max", "memory.current"), ("memory.limit_in_bytes", "memory.usage_in_bytes"))  # versions 2, 1


class ProcessorTimes(NamedTuple):
    """Seconds of all processors this process may run on, together, since the machine was started."""

    idle: float  # without work
    busy: float  # with work, whoever's; what a hypervisor has given to other virtual machines is among it


def processor_times() -> ProcessorTimes:
    """The times of now; all 0 where the kernel does not tell."""
    own = {f"cpu{number}" for number in os.sched_getaffinity(0)}
    idle = busy = 0
    with suppress(OSError, ValueError, IndexError), open("/proc/stat", encoding="utf-8") as file:  # noqa: PTH123 - hot
        for line in file:
            name, *columns = line.split()
            if not name.startswith("cpu"):
                break
            if name in own:
                times = [int(column) for column in columns[:_COLUMNS]]
                unused = times[_IDLE] + times[_WAITING_FOR_DISKS]
                idle += unused
                busy += sum(times) - unused
    return ProcessorTimes(idle / _TICKS, busy / _TICKS)


@lru_cache(maxsize=1)
def processor_share() -> float:
    """How much of one processor a single thread can get here: 1, or less in a container that is held to less."""
    return min([1.0, *(limit for group in own_groups("cpu") if (limit := _limit(group)) > 0.0)])


def free_memory() -> int:
    """Bytes that new programs may take, as the kernel estimates it, or a control group allows it; 0 if unknown.

    A group counts what it has read of files as used, although that would be given up.
    """
    rooms = []
    with suppress(OSError, ValueError, IndexError):
        rooms.append(int(_MEMORY.read_text(encoding="ascii").partition("MemAvailable:")[2].split()[0]) * 1024)
    for group in own_groups("memory"):
        for allowed, used in _OF_MEMORY:
            with suppress(OSError, ValueError):  # "max"
                bound, taken = (int((group / name).read_text(encoding="ascii")) for name in (allowed, used))
                rooms.append(bound - taken)
    return max(0, min(rooms, default=0))


def own_groups(controller: str) -> list[Path]:
    """The folders of the control groups this process is in, and of those around them, as far as they can be seen."""
    folders: list[Path] = []
    with suppress(OSError, ValueError):
        for line in _OWN_GROUPS.read_text(encoding="utf-8").splitlines():
            _, controllers, path = line.split(":", 2)
            if controllers and controller not in controllers.split(","):
                continue
            root = _CGROUPS / controller if controllers else _CGROUPS
            group = root / path.lstrip("/")
            folders += [folder for folder in (group, *group.parents) if folder.is_relative_to(root)]
    return folders


def _limit(group: Path) -> float:
    """Processors that all processes of a control group get together; infinite without a limit."""
    with suppress(OSError, ValueError, ZeroDivisionError):
        quota, period = (group / "cpu.max").read_text(encoding="utf-8").split()
        return math.inf if quota == "max" else int(quota) / int(period)
    with suppress(OSError, ValueError, ZeroDivisionError):  # version 1
        quota, period = ((group / f"cpu.cfs_{name}_us").read_text(encoding="utf-8") for name in ("quota", "period"))
        return math.inf if int(quota) < 0 else int(quota) / int(period)
    return math.inf
