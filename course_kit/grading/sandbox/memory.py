"""Memory that processes take from the machine, counted as exactly as /proc tells (proc(5))."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.process import tree

if TYPE_CHECKING:
    from collections.abc import Iterable

_BESIDE_PAGES = ("VmPTE:", "VmSwap:")  # the tables of pages, and what was swapped out


def exact_use(process_ids: Iterable[int], patience_s: float) -> int:
    """Bytes of memory these processes take from the machine: pages that forks share are counted once.

    Exact and slow, for a process that is just forking very slow: stops after `patience_s` seconds with what it has.
    """
    deadline = time.monotonic() + patience_s
    total = 0
    for process_id in process_ids:
        total += _proportional(process_id) + _beside_pages(process_id)
        if time.monotonic() > deadline:
            break
    return total


def _proportional(process_id: int) -> int:
    """Resident bytes, shared ones divided by their users; all of them for a process that hides the figures."""
    with suppress(OSError, ValueError, LookupError, StopIteration):
        text = Path(f"/proc/{tree.speaker(process_id)}/smaps_rollup").read_text(encoding="utf-8")
        return next(int(row.split()[1]) * 1024 for row in text.splitlines() if row.startswith("Pss:"))
    return tree.usage([process_id]).memory


def _beside_pages(process_id: int) -> int:
    with suppress(OSError, ValueError, LookupError):
        text = Path(f"/proc/{tree.speaker(process_id)}/status").read_text(encoding="utf-8", errors="replace")
        return sum(int(line.split()[1]) * 1024 for line in text.splitlines() if line.startswith(_BESIDE_PAGES))
    return 0


def oom_kills() -> int:
    """How many processes this machine has killed because its memory was used up, since it was started; 0 if unknown."""
    with suppress(OSError, ValueError, IndexError):
        text = Path("/proc/vmstat").read_text(encoding="ascii")
        return int(text.partition("oom_kill ")[2].split()[0])
    return 0
