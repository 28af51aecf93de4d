"""Memory that processes and sockets take from the machine, counted as exactly as /proc tells (proc(5)).

What was sent and nobody has received lies in the kernel, and in no process (socket(7)). It is counted where a
submission has a network to itself. The kernel tells it of UDP alone. Any other socket counts with as much as it can
hold, which is its usual buffers: `seccomp` grants no larger ones, and TCP has no others there (`bound_tcp_buffers`).
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

AREA = 256  # bytes that the kernel keeps about an area of a process's memory
AREAS_AT_MOST = 65530 * AREA
_BESIDE_PAGES = ("VmPTE:", "VmSwap:")  # the tables of pages, and what was swapped out
_USUAL = 212992  # bytes: the usual buffer of a socket in one direction (net.core.rmem_default and wmem_default)
_MOST = 4 * _USUAL  # where somebody has given all sockets of a machine larger ones, a few sockets are no offence
_UDP = ("/proc/net/udp", "/proc/net/udp6")
_TCP = ("/proc/sys/net/ipv4/tcp_rmem", "/proc/sys/net/ipv4/tcp_wmem")


def measure_memory(process_ids: Sequence[int], patience_s: float) -> int:
    """Bytes of memory these processes take from the machine: pages that forks share are counted once.

    Exact and slow, for a process that is just forking very slow: stops after `patience_s` seconds with what it has.
    What makes it slow are areas of memory: those of the others are taken to be as many, and no process is always last.
    """
    deadline = time.monotonic() + patience_s
    total, areas, counted = 0, 0, 0
    for process_id in random.sample(process_ids, len(process_ids)):
        total += _proportional(process_id) + _beside_pages(process_id)
        areas += _areas(process_id)
        counted += 1
        if time.monotonic() > deadline:
            break
    return total + areas * AREA * len(process_ids) // max(counted, 1)


def _areas(process_id: int) -> int:
    with suppress(OSError, LookupError):
        return Path(f"/proc/{tree.speaking_task(process_id)}/maps").read_bytes().count(b"\n")
    return 0


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
_RECEIVED = _read_number("/proc/sys/net/core/rmem_default", unknown=_USUAL)
_SENT = _read_number("/proc/sys/net/core/wmem_default", unknown=_USUAL)
_OF_UDP = _RECEIVED + _SENT
_OF_OTHERS = 2 * min(max(_SENT, _USUAL), _MOST)


def bound_tcp_buffers() -> None:
    """Give TCP in the network namespace of this process no larger buffers than other sockets have."""
    for path in _TCP:
        Path(path).write_text(f"4096 65536 {_USUAL}", encoding="ascii")


def count_sockets() -> int:
    """How many sockets this network namespace has: closed ones of which nobody has received all are among them."""
    return _read_number("/proc/net/sockstat", "sockets: used ")


def most_of_sockets(sockets: int) -> int:
    """Bytes that so many sockets can hold."""
    return sockets * max(_OF_UDP, _OF_OTHERS)


def measure_sockets(sockets: int) -> int:
    """Bytes that the sockets of this network namespace count with, so many as `count_sockets` has said."""
    queued = [line.split()[4].split(":") for path in _UDP for line in _rows(path)]
    of_udp = sum(int(sent, 16) + int(received, 16) for sent, received in queued)
    return of_udp + _OF_OTHERS * max(0, sockets - len(queued))


def _rows(path: str) -> list[str]:
    with suppress(OSError):
        return Path(path).read_text(encoding="ascii").splitlines()[1:]
    return []
