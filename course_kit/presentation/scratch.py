"""A folder for one presentation: its copies, JupyterLab's settings and workspace. It goes when the presentation ends.

Whatever was killed leaves its folder behind; the next presentation removes it. Who is alive holds a lock on theirs,
which the kernel takes back when a process ends, however it ends.
"""

from __future__ import annotations

import errno
import fcntl
import os
import shutil
import tempfile
import threading
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.text.console import tell

if TYPE_CHECKING:
    from collections.abc import Iterator

_LOCK = ".lock"
_PATIENCE_S = 10.0
_LOOK_S = 0.05


@contextmanager
def scratch_folder(parent: Path) -> Iterator[Path]:
    """A new folder that nobody else uses, removed at the end.

    Args:
        parent: where presentations have their folders.

    Raises:
        OSError: it cannot be made.
    """
    parent.mkdir(parents=True, exist_ok=True)
    with _locked(parent / _LOCK):
        for old in parent.iterdir():
            if old.is_dir() and not _is_held(old):
                _remove(old)
        made = Path(tempfile.mkdtemp(dir=parent))
        descriptor = _take(made / _LOCK)
    try:
        yield made
    finally:
        _remove(made)
        os.close(descriptor)
        if made.exists():
            tell(f"{made} could not be removed. Delete it by hand.")


def make_writable(folder: Path) -> None:
    """Let copies of folders that are read-only be changed, and removed."""
    for inner in (folder, *(path for path in folder.rglob("*") if path.is_dir() and not path.is_symlink())):
        with suppress(OSError):
            inner.chmod(0o700)


def _remove(folder: Path) -> None:
    make_writable(folder)
    shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    """One presentation at a time looks through the folders: a new one has no lock for a moment."""
    descriptor = _take(path)
    try:
        yield
    finally:
        os.close(descriptor)


def _take(path: Path) -> int:
    # Closed when another program is started: nobody who outlives this process holds the lock.
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    deadline = time.monotonic() + _PATIENCE_S
    pause = threading.Event()  # nobody tells when a lock becomes free: look again and again, with a deadline
    while not _lock(descriptor):
        if time.monotonic() >= deadline:
            os.close(descriptor)
            raise TimeoutError(errno.ETIMEDOUT, "another presentation keeps it locked", str(path))
        pause.wait(_LOOK_S)
    return descriptor


def _lock(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _is_held(folder: Path) -> bool:
    try:
        descriptor = os.open(folder / _LOCK, os.O_RDWR | os.O_CLOEXEC)
    except OSError:  # it was killed before it had one
        return False
    try:
        return not _lock(descriptor)
    finally:
        os.close(descriptor)
