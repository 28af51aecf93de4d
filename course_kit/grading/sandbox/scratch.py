"""The folder of a worker, below which each of its submissions gets its own scratch directory.

It bears the worker's number: what a killed worker could not remove, the next one does.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from contextlib import suppress
from pathlib import Path

_PREFIX = "course-kit-worker-"
_MODE = 0o711  # a submission that runs as its own user finds its directory in it, and sees no other
_NAME = re.compile(rf"{_PREFIX}(?P<process>\d+)-\w+\Z")


def make() -> Path:
    """Make the folder of this process, and remove those of workers of the same user that live no more."""
    for path in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        with suppress(OSError):  # somebody else removes it at the same time
            if _is_left_over(path):
                remove(path)
    folder = Path(tempfile.mkdtemp(prefix=f"{_PREFIX}{os.getpid()}-"))
    folder.chmod(_MODE)
    return folder


def clear(folder: Path) -> None:
    """Remove what a grading that was broken off has left in the folder, and make it anew if somebody has removed it."""
    folder.mkdir(mode=0o700, exist_ok=True)
    folder.chmod(_MODE)  # whatever the mask of this process is
    for path in folder.iterdir():
        remove(path)


def remove(folder: Path) -> None:
    """Remove a folder and all in it, as far as that is possible."""
    shutil.rmtree(folder, ignore_errors=True)


def _is_left_over(path: Path) -> bool:
    match = _NAME.match(path.name)
    if match is None or path.is_symlink() or path.stat().st_uid != os.getuid():
        return False
    return not Path(f"/proc/{match['process']}").exists()
