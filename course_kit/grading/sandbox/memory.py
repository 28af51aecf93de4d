"""Memory that processes take from the machine, counted as exactly as /proc tells (proc(5))."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.process import tree

if TYPE_CHECKING:
    from collections.abc import Iterable

_IN_MEMORY = ("/memfd:", "/dev/shm/", "/dev/zero (deleted)", "/SYSV")  # noqa: S108 - as /proc names what is open


def exact_use(process_ids: Iterable[int], files: int, patience_s: float) -> int:
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
        return tree.usage([process_id]).memory, 0


def in_files(process_ids: Iterable[int], patience_s: float) -> int:
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


def oom_kills() -> int:
    """How many processes this machine has killed because its memory was used up, since it was started; 0 if unknown."""
    with suppress(OSError, ValueError, IndexError):
        text = Path("/proc/vmstat").read_text(encoding="ascii")
        return int(text.partition("oom_kill ")[2].split()[0])
    return 0
