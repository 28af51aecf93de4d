"""One set-up of a folder at a time, by a lock that the kernel takes away when its owner ends, however it ends.

A record lock (fcntl(2)): Python has it wherever it runs, while the flock command is missing on macOS; it works on NFS;
and the kernel tells who holds it, so that what the waiting one says is true.
"""

from __future__ import annotations

import errno
import fcntl
import os
import struct
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_setup.problems import SetUpError, say

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PATIENCE_S = 1800.0  # a slow network takes minutes for an installation
_LOOK_EVERY_S = 0.2
_HELD = (errno.EACCES, errno.EAGAIN)
_NO_LOCKS = (errno.ENOLCK, errno.EOPNOTSUPP, errno.EINVAL, errno.ENOSYS)


@contextmanager
def held(path: Path, patience_s: float = PATIENCE_S) -> Iterator[None]:
    """Hold the lock of this file, made if need be.

    Where a file system has no locks it goes on without one: two set-ups at once only do the work twice.

    Args:
        path: the file.
        patience_s: how long to wait for another process, in seconds.

    Raises:
        SetUpError: another process has held it all the time.
        OSError: the file cannot be written.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    try:
        _wait_for(descriptor, patience_s)
        yield
    finally:
        os.close(descriptor)  # and with it the lock


@contextmanager
def held_if_free(path: Path) -> Iterator[bool]:
    """Hold the lock if nobody else does, and tell whether it is held.

    Raises:
        OSError: the file cannot be written.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    try:
        yield _take(descriptor)
    finally:
        os.close(descriptor)


def _wait_for(descriptor: int, patience_s: float) -> None:
    deadline = time.monotonic() + patience_s
    told = False
    while not _take(descriptor):
        if not told:
            say(f"waiting for another set-up of this folder: {_holder(descriptor)}. Ctrl-C stops waiting.")
            told = True
        if time.monotonic() > deadline:
            raise SetUpError(
                f"Another set-up of this folder has not finished within {patience_s / 60:.0f} minutes: "
                f"{_holder(descriptor)}. Stop it, then run the same command again."
            )
        time.sleep(_LOOK_EVERY_S)  # a wait in the kernel would have no deadline
    os.utime(descriptor)  # since when it is held


def _take(descriptor: int) -> bool:
    try:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in _HELD:
            return False
        if error.errno in _NO_LOCKS:
            return True
        raise
    return True


def _holder(descriptor: int) -> str:
    """Who holds the lock, by the kernel's own word, and since when."""
    since = time.strftime("%H:%M:%S", time.localtime(os.fstat(descriptor).st_mtime))
    process_id = _process_that_holds(descriptor)
    if process_id <= 0:  # of another container, or of another machine
        return f"a process that cannot be seen from here, since {since}"
    return f"process {process_id}, since {since}"


def _process_that_holds(descriptor: int) -> int:
    """The process id in what F_GETLK answers; `struct flock` has its fields in another order on macOS."""
    if sys.platform == "darwin":
        request = struct.pack("qqihh", 0, 0, 0, fcntl.F_WRLCK, os.SEEK_SET)
        return int(struct.unpack("qqihh", fcntl.fcntl(descriptor, fcntl.F_GETLK, request))[2])
    request = struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)
    return int(struct.unpack("hhqqi", fcntl.fcntl(descriptor, fcntl.F_GETLK, request))[4])
