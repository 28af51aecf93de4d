"""One run at a time in one folder of results: a lock that the system releases when its holder ends, however it ends."""

from __future__ import annotations

import fcntl
import getpass
import json
import os
import socket
from contextlib import contextmanager
from datetime import datetime
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

FILE = ".run.lock"  # stays when the run has ended: taking it away would let two hold it
_LONGEST = 1000  # bytes


@contextmanager
def hold(folder: Path) -> Iterator[None]:
    """Have a folder of results for this process alone; makes the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    # Closed when another program is started: nobody who outlives this process holds the lock.
    descriptor = os.open(folder / FILE, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
    try:
        _take(descriptor, folder)
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, json.dumps(_holder()).encode(), 0)
        yield
    finally:
        os.close(descriptor)


def _take(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise GradingError(
            f"Another run is at work in {folder}: {_told(os.pread(descriptor, _LONGEST, 0))}. Wait until it has ended, "
            "or name another folder."
        ) from None
    except OSError as problem:
        raise GradingError(
            f"The file system of {folder} cannot lock files ({problem.strerror}), so that two runs could mix their "
            "results. Name a folder on a local disk."
        ) from problem


def _holder() -> dict[str, object]:
    try:
        user = getpass.getuser()
    except (OSError, KeyError, ImportError):  # a user whom the system does not know
        user = str(os.getuid())
    now = datetime.now().astimezone()
    return {"process": os.getpid(), "host": socket.gethostname(), "user": user, "since": f"{now:%Y-%m-%d %H:%M:%S %z}"}


def _told(text: bytes) -> str:
    """Who holds it."""
    try:
        holder = json.loads(text)
        return one_line(f"process {holder['process']} of {holder['user']} on {holder['host']}, since {holder['since']}")
    except (ValueError, KeyError, TypeError):
        return "it has just begun"
