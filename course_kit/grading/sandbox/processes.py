"""Counting and ending processes through /proc (proc(5)).

Works in whatever PID namespace /proc belongs to: the number of the calling process is read from /proc/self.
"""

from __future__ import annotations

import os
import signal
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Container, Iterable

_TICKS = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")
_IN_MEMORY = ("/memfd:", "/dev/shm/", "/dev/zero (deleted)", "/SYSV")  # noqa: S108 - as /proc names what is open


@dataclass(frozen=True)
class Usage:
    """What some processes use together.

    Attributes:
        cpu_s: seconds of computing; children that they have waited for are among it.
        tasks: processes and threads.
        memory: resident bytes, what forks share counted for each of them.
    """

    cpu_s: float = 0.0
    tasks: int = 0
    memory: int = 0


def descendants(root: int) -> list[int]:
    """All living or unreaped processes below `root`, parents before children."""
    children: dict[int, list[int]] = {}
    for name in os.listdir("/proc"):  # noqa: PTH208 - hot
        if name.isdecimal():
            with suppress(OSError, ValueError, IndexError):
                children.setdefault(int(_stat(int(name))[1]), []).append(int(name))
    found, pending = [], [root]
    while pending:
        below = children.get(pending.pop(), [])
        found.extend(below)
        pending.extend(below)
    return found


def all_but(process_id: int) -> list[int]:
    """All processes that /proc shows, without one: the quick way to all descendants of process 1 of a PID namespace."""
    numbers = (int(name) for name in os.listdir("/proc") if name.isdecimal())  # noqa: PTH208 - hot
    return [number for number in numbers if number != process_id]


def this_process() -> int:
    """The number of this process as /proc knows it."""
    return int(Path("/proc/self").readlink().name)


def usage(process_ids: Iterable[int]) -> Usage:
    """What these processes use together; of those that have ended only what their parents were told counts."""
    cpu_s, tasks, memory = 0.0, 0, 0
    for process_id in process_ids:
        with suppress(OSError, ValueError, IndexError):
            fields = _stat(process_id)
            cpu_s += sum(map(int, fields[11:15])) / _TICKS
            tasks += int(fields[17])
            memory += int(fields[21]) * _PAGE
    return Usage(cpu_s, tasks, memory)


def own_memory(process_ids: Iterable[int], files: int, patience_s: float) -> int:
    """Bytes of memory these processes take from the machine: pages that forks share are counted once.

    Exact and slow, for a process that is just forking very slow: stops after `patience_s` seconds with what it has.

    Args:
        process_ids: the processes.
        files: bytes in their files in memory, of which some are mapped and counted that way already.
        patience_s: seconds.
    """
    deadline = time.monotonic() + patience_s
    total = mapped = 0
    for process_id in process_ids:
        own, shared = _proportional(process_id)
        total += own
        mapped += shared
        if time.monotonic() > deadline:
            break
    return total + max(0, files - mapped)


def _proportional(process_id: int) -> tuple[int, int]:
    """Resident bytes, shared ones divided by their users, and those in files in memory among them.

    All resident bytes for a process that hides the figures.
    """
    try:
        text = Path(f"/proc/{process_id}/smaps_rollup").read_text(encoding="utf-8")
        rows = {row.partition(":")[0]: row.split()[1] for row in text.splitlines()[1:]}
        return int(rows["Pss"]) * 1024, int(rows.get("Pss_Shmem", 0)) * 1024
    except (OSError, ValueError, LookupError):
        return usage([process_id]).memory, 0


def memory_files(process_ids: Iterable[int], patience_s: float) -> int:
    """Bytes in files that exist in memory alone, mapped or not: those of memfd_create(2), and deleted ones of a tmpfs.

    Stops after `patience_s` seconds with what it has.
    """
    deadline = time.monotonic() + patience_s
    sizes: dict[tuple[int, int], int] = {}
    for process_id in process_ids:
        folder = f"/proc/{process_id}/fd"
        with suppress(OSError):
            for name in os.listdir(folder):  # noqa: PTH208 - hot
                with suppress(OSError):
                    if os.readlink(f"{folder}/{name}").startswith(_IN_MEMORY):  # noqa: PTH115 - hot
                        status = os.stat(f"{folder}/{name}")  # noqa: PTH116 - hot
                        sizes[status.st_dev, status.st_ino] = status.st_blocks * 512
        if time.monotonic() > deadline:
            break
    return sum(sizes.values())


def tasks_of_user(user: int) -> int:
    """Processes and threads of a user."""
    tasks = 0
    for name in os.listdir("/proc"):  # noqa: PTH208 - hot
        if name.isdecimal():
            with suppress(OSError, ValueError, IndexError, StopIteration):
                if _user(name) == user:
                    tasks += int(_stat(int(name))[17])
    return tasks


def _user(name: str) -> int:
    """Whose process it is; the files of one that forbids tracing belong to root, whoever's it is."""
    owner = Path(f"/proc/{name}").stat().st_uid
    if owner:
        return owner
    with open(f"/proc/{name}/status", encoding="utf-8", errors="replace") as file:  # noqa: PTH123 - hot
        return next(int(line.split()[1]) for line in file if line.startswith("Uid:"))


def killed_for_lack_of_memory() -> int:
    """How many processes this machine has killed because its memory was used up, since it was started; 0 if unknown."""
    with suppress(OSError, ValueError, IndexError):
        text = Path("/proc/vmstat").read_text(encoding="ascii")
        return int(text.partition("oom_kill ")[2].split()[0])
    return 0


def end_descendants(keep: Container[int] = ()) -> None:
    """Kill everything below this process but the children `keep` and what hangs on them; returns when all are gone.

    Needs `namespaces.adopt_orphans`: the orphans that killing makes come to us. Repeats until nothing is left,
    so that a program which forks while it is being killed does not escape.
    """
    own = this_process()
    listed = _listed_children
    while True:
        doomed = [child for child in listed(own) if child not in keep]
        if not doomed:
            if listed is _all_children or (not keep and _childless()):
                return
            listed = _all_children  # the kernel's list may lack a child when another ends just then
            continue
        for process_id in (*doomed, *(below for child in doomed for below in _below(child))):
            with suppress(ProcessLookupError):
                os.kill(process_id, signal.SIGKILL)
        for child in doomed:
            with suppress(ChildProcessError):
                os.waitpid(child, 0)


def _childless() -> bool:
    """Whether this process has no child, living or unreaped."""
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return True
    return False


def _below(process_id: int) -> list[int]:
    found, pending = [], [process_id]
    while pending:
        below = _listed_children(pending.pop())
        found.extend(below)
        pending.extend(below)
    return found


def _listed_children(parent: int) -> list[int]:
    """The children by the kernel's own list, without a look at every process of the machine."""
    found: list[int] = []
    try:
        for thread in os.listdir(f"/proc/{parent}/task"):  # noqa: PTH208 - hot
            with open(f"/proc/{parent}/task/{thread}/children", encoding="utf-8") as file:  # noqa: PTH123 - hot
                found += map(int, file.read().split())
    except FileNotFoundError:  # it has ended, or this kernel keeps no such lists (CONFIG_PROC_CHILDREN)
        return _all_children(parent)
    except OSError:
        return found
    return found


def _all_children(parent: int) -> list[int]:
    found = []
    for name in os.listdir("/proc"):  # noqa: PTH208 - hot
        if name.isdecimal():
            with suppress(OSError, ValueError, IndexError):
                if int(_stat(int(name))[1]) == parent:
                    found.append(int(name))
    return found


def _stat(process_id: int) -> list[str]:
    """The fields of /proc/PID/stat from the third, the state, on: the second, the name, may hold anything."""
    with open(f"/proc/{process_id}/stat", encoding="utf-8", errors="replace") as file:  # noqa: PTH123 - hot
        return file.read().rpartition(")")[2].split()
