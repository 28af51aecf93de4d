"""A folder for one presentation: its copies, JupyterLab's settings and workspace. It goes when the presentation ends.

Whatever was killed leaves its folder behind; the next presentation removes it. A folder is named after its process.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.text.console import note

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def scratch_folder(parent: Path) -> Iterator[Path]:
    """A new folder that nobody else uses, removed at the end."""
    parent.mkdir(parents=True, exist_ok=True)
    for old in parent.iterdir():
        if old.is_dir() and not _is_running(old.name.partition("-")[0]):
            _remove(old)
    made = Path(tempfile.mkdtemp(prefix=f"{os.getpid()}-", dir=parent))
    try:
        yield made
    finally:
        _remove(made)
        if made.exists():
            note(f"{made} could not be removed. Delete it by hand.")


def make_writable(folder: Path) -> None:
    """Let copies of folders that are read-only be changed, and removed."""
    for inner in (folder, *(path for path in folder.rglob("*") if path.is_dir() and not path.is_symlink())):
        with suppress(OSError):
            inner.chmod(0o700)


def _remove(folder: Path) -> None:
    make_writable(folder)
    shutil.rmtree(folder, ignore_errors=True)


def _is_running(process_id: str) -> bool:
    try:
        os.kill(int(process_id), 0)
    except (ValueError, ProcessLookupError):
        return False
    except PermissionError:  # the number is somebody else's by now, or the home directory is shared
        pass
    return True
