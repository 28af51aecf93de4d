"""Memory that processes and sockets take from the machine, counted as exactly as /proc tells (proc(5)).

What was sent and nobody has received lies in the kernel, and in no process (socket(7)). Where a submission has a
network to itself, each socket counts with as much as it can hold.
"""

from __future__ import annotations

import random
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.process import tree

if TYPE_CHECKING:
    from collections.abc import Sequence

_BESIDE_PAGES = ("VmPTE:", "VmSwap:")  # the tables of pages, and what was swapped out
_USUAL = 212992  # bytes: the usual buffer of a socket in one direction (net.core.rmem_default and wmem_default)
_MOST = 4 * _USUAL  # where somebody has given all sockets of a machine larger ones, a few sockets are no offence
_TCP = ("/proc/sys/net/ipv4/tcp_rmem", "/proc/sys/net/ipv4/tcp_wmem")


def measure_memory(process_ids: Sequence[int], patience_s: float) -> int:
    """Bytes of memory these processes take from the machine: pages that forks share are counted once."""
    deadline = time.monotonic() + patience_s
    total = 0
    for process_id in random.sample(process_ids, len(process_ids)):  # no process is always last
        total += _proportional(process_id) + _beside_pages(process_id)
        if time.monotonic() > deadline:
            break
    return total


def _proportional(process_id: int) -> int:
    """Resident bytes, shared ones divided by their users; all of them for a process that hides the figures."""
    with suppress(OSError, ValueError, LookupError, StopIteration):
        text = Path(f"/proc/{tree.speaking_task(process_id)}/smaps_rollup").read_text(encoding="utf-8")
        return next(int(row.split()[1]) * 1024 for row in text.splitlines() if row.startswith("Pss:"))
    return tree.measure_usage([process_id]).memory


def _beside_pages(process_id: int) -> int:
    with suppress(OSError, ValueError, LookupError):
        text = Path(f"/proc/{tree.speaking_task(process_id)}/status").read_text(encoding="utf-8", errors="replace")
        return sum(int(line.split()[1]) * 1024 for line in text.splitlines() if line.startswith(_BESIDE_PAGES))
    return 0


def count_oom_kills() -> int:
    """How many processes this machine has killed because its memory was used up, since it was started; 0 if unknown."""
    return _read_number("/proc/vmstat", "oom_kill ")


def _read_number(path: str, words: str = "", unknown: int = 0) -> int:
    """The number behind these words in a file of the kernel's."""
    with suppress(OSError, ValueError, IndexError):
        text = Path(path).read_text(encoding="ascii")
        return int(text[text.index(words) + len(words) :].split()[0])
    return unknown


# Read at first: not every kernel shows it in a network namespace.
_BUFFERS = [_read_number(f"/proc/sys/net/core/{name}_default", unknown=_USUAL) for name in ("rmem", "wmem")]
_OF_A_SOCKET = 2 * min(max(_USUAL, *_BUFFERS), _MOST)


def bound_tcp_buffers() -> None:
    """Give TCP in the network namespace of this process no larger buffers than other sockets have."""
    for path in _TCP:
        Path(path).write_text(f"4096 65536 {_USUAL}", encoding="ascii")


def bytes_of_sockets(sockets: int | None = None) -> int:
    """Bytes that so many sockets can hold, or those of this network namespace, closed ones that are not empty, too."""
    return _OF_A_SOCKET * (_read_number("/proc/net/sockstat", "sockets: used ") if sockets is None else sockets)
