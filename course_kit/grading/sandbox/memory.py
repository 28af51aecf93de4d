"""Memory that processes take from the machine, counted as exactly as /proc tells (proc(5))."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.process import tree

if TYPE_CHECKING:
    from collections.abc import Iterable

_IN_MEMORY = ("/memfd:", "/dev/shm/", "/dev/zero (deleted)", "/SYSV")  # noqa: S108 - as /proc names what is open


class Held(NamedTuple):
    """What processes hold in memory by their descriptors.

    Attributes:
        files: bytes in files that exist in memory alone, mapped or not: those of memfd_create(2), and deleted ones.
        sockets: how many sockets.
        hidden: whether a process does not let its descriptors be seen.
    """

    files: int = 0
    sockets: int = 0
    hidden: bool = False


def exact_use(process_ids: Iterable[int], files: int, patience_s: float) -> int:
    """Bytes of memory these processes take from the machine: pages that forks share are counted once.

    Exact and slow, for a process that is just forking very slow: stops after `patience_s` seconds with what it has.
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
        text = Path(f"/proc/{tree.speaker(process_id)}/smaps_rollup").read_text(encoding="utf-8")
        rows = {row.partition(":")[0]: row.split()[1] for row in text.splitlines()[1:]}
        return int(rows["Pss"]) * 1024, int(rows.get("Pss_Shmem", 0)) * 1024
    except (OSError, ValueError, LookupError):
        return tree.usage([process_id]).memory, 0


def held(process_ids: Iterable[int], patience_s: float) -> Held:
    """What these processes hold; stops after `patience_s` seconds with what it has."""
    deadline = time.monotonic() + patience_s
    sizes: dict[tuple[int, int], int] = {}
    sockets: set[str] = set()
    hidden = False
    for process_id in process_ids:
        try:
            _note_all_held(process_id, sizes, sockets)
        except PermissionError:
            hidden = True
        except OSError:  # it has ended
            continue
        if time.monotonic() > deadline:
            break
    return Held(sum(sizes.values()), len(sockets), hidden)


def _note_all_held(process_id: int, sizes: dict[tuple[int, int], int], sockets: set[str]) -> None:
    """Add what a process holds, whichever of its threads /proc tells it by."""
    for number_of in (int, tree.speaker):
        number = number_of(process_id)
        try:
            if _note_held(number, sizes, sockets):
                return
        except PermissionError:
            if tree.has_memory(number):  # else it is about to end, and belongs to root from then on
                raise


def _note_held(process_id: int, sizes: dict[tuple[int, int], int], sockets: set[str]) -> bool:
    """Add files in memory, by device and number, and sockets, by name; whether anything at all is open."""
    folder = f"/proc/{process_id}/fd"
    names = os.listdir(folder)  # noqa: PTH208 - hot
    for name in names:
        with suppress(FileNotFoundError):  # closed meanwhile
            target = os.readlink(f"{folder}/{name}")  # noqa: PTH115 - hot
            if target.startswith(_IN_MEMORY):
                status = os.stat(f"{folder}/{name}")  # noqa: PTH116 - hot
                sizes[status.st_dev, status.st_ino] = status.st_blocks * 512
            elif target.startswith("socket:"):
                sockets.add(target)
    return bool(names)


def oom_kills() -> int:
    """How many processes this machine has killed because its memory was used up, since it was started; 0 if unknown."""
    with suppress(OSError, ValueError, IndexError):
        text = Path("/proc/vmstat").read_text(encoding="ascii")
        return int(text.partition("oom_kill ")[2].split()[0])
    return 0
