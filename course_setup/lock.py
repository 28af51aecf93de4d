"""One set-up of a folder at a time, by a lock that the kernel takes away when its owner ends, however it ends.

A record lock (fcntl(2)): it works on NFS, and the kernel says who holds it.
"""

from __future__ import annotations

import errno
import fcntl
import os
import struct
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_setup.problems import SetUpError, say

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PATIENCE_S = 1800.0  # a slow network takes minutes for an installation
_LOOK_EVERY_S = 0.2


@contextmanager
def held(path: Path, patience_s: float = PATIENCE_S) -> Iterator[bool]:
    """Hold the lock of this file, made if need be, and tell whether another process had it before.

    Raises:
        SetUpError: another process has held it for `patience_s` seconds.
        OSError: the file cannot be written.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    try:
        yield _wait_for(descriptor, patience_s)
    finally:
        os.close(descriptor)  # and with it the lock


def _wait_for(descriptor: int, patience_s: float) -> bool:
    deadline = time.monotonic() + patience_s
    waited = False
    while not _take(descriptor):
        if not waited:
            say(f"waiting for another set-up of this folder: {_holder(descriptor)}. Ctrl-C stops waiting.")
        waited = True
        if time.monotonic() > deadline:
            raise SetUpError(
                f"Another set-up of this folder has not finished within {patience_s / 60:.0f} minutes: "
                f"{_holder(descriptor)}. Stop it, then run the same command again."
            )
        time.sleep(_LOOK_EVERY_S)  # a wait in the kernel would have no deadline
    return waited


def _take(descriptor: int) -> bool:
    try:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in (errno.EACCES, errno.EAGAIN):
            return False
        raise
    return True


def _holder(descriptor: int) -> str:
    request = struct.pack("hhqqi", fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)
    process_id = struct.unpack("hhqqi", fcntl.fcntl(descriptor, fcntl.F_GETLK, request))[4]
    # Of another container, or of another machine, the kernel gives no number.
    return f"process {process_id}" if process_id > 0 else "a process that cannot be seen from here"
