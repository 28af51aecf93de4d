"""The processes below one: which they are, what they use, and their end, through /proc (proc(5)).

Works in whatever PID namespace /proc belongs to: the number of the calling process is read from /proc/self.
"""

from __future__ import annotations

import os
import signal
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

_TICKS = os.sysconf("SC_CLK_TCK")
_ENDED = "Z"  # as a state: of a process, or of its first thread while others go on
_PAGE = os.sysconf("SC_PAGE_SIZE")
_TABLE_ENTRY = 8  # bytes of a page's table for each page


@dataclass(frozen=True)
class Usage:
    """What some processes use together."""

    cpu_s: float = 0.0
    tasks: int = 0
    memory: int = 0
    tables: int = 0


def descendants_of(root: int) -> list[int]:
    """All living or unreaped processes below `root`, parents before children."""
    return _list_below(root, _children().get)


def all_but(process_id: int) -> list[int]:
    """All processes that /proc shows, without one: the quick way to all descendants of process 1 of a PID namespace."""
    return [number for number in _list_processes() if number != process_id]


def this_process() -> int:
    """The number of this process as /proc knows it."""
    return int(Path("/proc/self").readlink().name)


def measure_usage(process_ids: Iterable[int]) -> Usage:
    """What these processes use together; those that have ended count only as far as their parents know."""
    cpu_s, tasks, memory, tables = 0.0, 0, 0, 0
    for process_id in process_ids:
        with suppress(OSError, ValueError, IndexError):
            fields = _stat(process_id)
            if fields[0] == _ENDED and int(fields[17]) > 1:
                fields = _stat(speaking_task(process_id))
            cpu_s += sum(map(int, fields[11:15])) / _TICKS
            tasks += int(fields[17])
            memory += int(fields[21]) * _PAGE
            tables += int(fields[20]) // _PAGE * _TABLE_ENTRY
    return Usage(cpu_s, tasks, memory, tables)


def speaking_task(process_id: int) -> int:
    """A number by which /proc tells a process's memory and files: its own, or a thread's if the first has ended."""
    if _stat(process_id)[0] != _ENDED:
        return process_id
    for thread in map(int, os.listdir(f"/proc/{process_id}/task")):  # noqa: PTH208 - hot
        with suppress(OSError, IndexError):
            if thread != process_id and _stat(thread)[0] != _ENDED:
                return thread
    return process_id


def tasks_of_user(user: int) -> int:
    """Processes and threads of a user."""
    tasks = 0
    for process_id in _list_processes():
        with (
            suppress(OSError, ValueError, KeyError),
            open(f"/proc/{process_id}/status", encoding="utf-8", errors="replace") as file,  # noqa: PTH123 - hot
        ):
            fields = dict(line.split(":", 1) for line in file)
            if int(fields["Uid"].split()[0]) == user:
                tasks += int(fields["Threads"])
    return tasks


def end_descendants() -> None:
    """Kill everything below this process; returns when all are gone.

    Needs `libc.adopt_orphans`: the orphans that killing makes come to us. Repeats until nothing is left,
    so that a program which forks while it is being killed does not escape.
    """
    own = this_process()
    while True:
        try:
            os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
        except ChildProcessError:  # living or unreaped
            return
        # The kernel's list may lack a child when another ends just then.
        doomed = _listed_children(own) or _children().get(own, [])
        for process_id in (*doomed, *(below for child in doomed for below in _list_below(child, _listed_children))):
            with suppress(ProcessLookupError):
                os.kill(process_id, signal.SIGKILL)
        for child in doomed:
            with suppress(ChildProcessError):
                os.waitpid(child, 0)


def _list_below(process_id: int, children_of: Callable[[int], list[int] | None]) -> list[int]:
    """All processes below one, parents before children."""
    found, pending = [], [process_id]
    while pending:
        below = children_of(pending.pop()) or []
        found.extend(below)
        pending.extend(below)
    return found


def _listed_children(parent: int) -> list[int]:
    """The children by the kernel's own list, without a look at every process of the machine."""
    found: list[int] = []
    with suppress(OSError):  # it has ended, or this kernel keeps no such lists (CONFIG_PROC_CHILDREN)
        for thread in os.listdir(f"/proc/{parent}/task"):  # noqa: PTH208 - hot
            with open(f"/proc/{parent}/task/{thread}/children", encoding="utf-8") as file:  # noqa: PTH123 - hot
                found += map(int, file.read().split())
    return found


def _children() -> dict[int, list[int]]:
    """The children of every process that has some."""
    found: dict[int, list[int]] = {}
    for process_id in _list_processes():
        with suppress(OSError, ValueError, IndexError):
            found.setdefault(int(_stat(process_id)[1]), []).append(process_id)
    return found


def _list_processes() -> list[int]:
    return [int(name) for name in os.listdir("/proc") if name.isdecimal()]  # noqa: PTH208 - hot


def _stat(process_id: int) -> list[str]:
    """The fields of /proc/PID/stat from the third, the state, on: the second, the name, may hold anything."""
    with open(f"/proc/{process_id}/stat", encoding="utf-8", errors="replace") as file:  # noqa: PTH123 - hot
        return file.read().rpartition(")")[2].split()
