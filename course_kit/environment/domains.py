"""ROS domains as leases: no two courses, and no two graders, on one machine ever share a graph.

A domain is a number; whoever uses the same number on the same machine sees the same graph, other users
included. So the numbers 1 to 101 (safe beside the kernel's ephemeral ports, see "The ROS_DOMAIN_ID" among the
ROS 2 concepts; 0 is left to the user's own robots) are handed out through locked files. The kernel drops the
lock when the process ends, however it ends: a crash never leaks a domain.
"""

from __future__ import annotations

import fcntl
import os
import tempfile
import threading
import time
import zlib
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

FIRST, LAST = 1, 101
_EXCLUSIVE = "exclusive"
_QUEUE_S = 0.05  # how often one who queues for a domain looks


class NoDomainError(RuntimeError):
    """Every domain of this machine is in use."""

    def __init__(self) -> None:
        super().__init__(
            f"All ROS domains from {FIRST} to {LAST} on this machine are in use by courses or graders. "
            "Close some of them, or set ROS_DOMAIN_ID to a number you know is free."
        )


@dataclass
class Lease:
    """A domain this process may use until it lets go of it."""

    domain_id: int
    _descriptor: int

    def release(self) -> None:
        """Give the domain back. Safe to call twice."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


def lease_folder() -> Path:
    """The machine-wide folder of the lock files, shared by all users like the ports they stand for."""
    folder = Path(tempfile.gettempdir()) / "ros2-course-kit-domains"
    previous = os.umask(0)
    try:
        folder.mkdir(mode=0o1777, exist_ok=True)
    finally:
        os.umask(previous)
    return folder


def share(owner: str) -> Lease:
    """Lease the domain of `owner`, together with every other process of the same owner.

    The number is stable: it follows from the owner's name, or is the one its living processes use already.

    Raises:
        NoDomainError: all are taken.
    """
    with _catalogue_locked():
        for domain_id in _candidates(owner):
            if _owner(domain_id) == owner and (lease := _lock(domain_id, fcntl.LOCK_SH)):
                return lease
        return _take(_candidates(owner), owner, fcntl.LOCK_SH)


def exclusive(patience_s: float = 0.0) -> Lease:
    """Lease a domain nobody else uses.

    Args:
        patience_s: for how many seconds to queue for one while all are taken.

    Raises:
        NoDomainError: all are taken, and stayed so.
    """
    deadline = time.monotonic() + patience_s
    pause = threading.Event()  # a lock that becomes free tells nobody: look again and again, with a deadline
    while True:
        try:
            with _catalogue_locked():
                return _take(range(LAST, FIRST - 1, -1), _EXCLUSIVE, fcntl.LOCK_EX)
        except NoDomainError:
            if time.monotonic() >= deadline:
                raise
        pause.wait(_QUEUE_S)


@contextmanager
def exclusive_domain(patience_s: float = 0.0) -> Iterator[int]:
    """`exclusive` as a context manager that yields the domain's number."""
    lease = exclusive(patience_s)
    try:
        yield lease.domain_id
    finally:
        lease.release()


def _candidates(owner: str) -> list[int]:
    count = LAST - FIRST + 1
    start = zlib.crc32(owner.encode()) % count
    return [FIRST + (start + step) % count for step in range(count)]


def _take(candidates: range | list[int], owner: str, mode: int) -> Lease:
    for domain_id in candidates:
        lease = _lock(domain_id, fcntl.LOCK_EX)
        if lease is None:
            continue
        os.ftruncate(lease._descriptor, 0)  # noqa: SLF001 - this module makes and unmakes leases
        os.pwrite(lease._descriptor, owner.encode(), 0)  # noqa: SLF001
        if mode != fcntl.LOCK_EX:
            # Not atomic in itself (see flock(2)); the catalogue's lock keeps everybody else away meanwhile.
            fcntl.flock(lease._descriptor, mode)  # noqa: SLF001
        return lease
    raise NoDomainError


def _owner(domain_id: int) -> str:
    try:
        return (lease_folder() / str(domain_id)).read_text(encoding="ascii", errors="replace")
    except OSError:
        return ""


def _lock(domain_id: int, mode: int) -> Lease | None:
    try:
        descriptor = _open(str(domain_id))
    except PermissionError:  # another user's file, made by hand or under a strange umask
        return None
    try:
        fcntl.flock(descriptor, mode | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        return None
    return Lease(domain_id, descriptor)


@contextmanager
def _catalogue_locked() -> Iterator[None]:
    descriptor = _open("catalogue")
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _open(name: str) -> int:
    path = lease_folder() / name
    flags = os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC
    try:
        return os.open(path, flags)  # first without O_CREAT: Linux refuses that on another user's file in /tmp
    except FileNotFoundError:
        descriptor = os.open(path, flags | os.O_CREAT, 0o666)
        if os.fstat(descriptor).st_uid == os.getuid():
            os.fchmod(descriptor, 0o666)  # whatever the umask: other users lease from the same files
        return descriptor
