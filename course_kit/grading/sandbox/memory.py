"""Memory that processes take from the machine, counted as exactly as /proc tells (proc(5))."""

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


def exact_use(process_ids: Sequence[int], patience_s: float) -> int:
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


def oom_kills() -> int:
    """How many processes this machine has killed because its memory was used up, since it was started; 0 if unknown."""
    with suppress(OSError, ValueError, IndexError):
        text = Path("/proc/vmstat").read_text(encoding="ascii")
        return int(text.partition("oom_kill ")[2].split()[0])
    return 0
