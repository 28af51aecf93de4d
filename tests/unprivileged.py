"""Commands as an ordinary user, and files that such a user cannot change, whoever runs the tests.

Root may write everywhere. So as root a command runs as a user whom the system does not know, with the one right that it
needs to reach a Python below /root: to read everything.
"""

from __future__ import annotations

import os
import stat
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_SOMEBODY = 54321
_RIGHT = "+dac_read_search"


def as_somebody(*command: str) -> list[str]:
    """The command, to be run without rights."""
    if os.geteuid() != 0:
        return list(command)
    user = ["--reuid", str(_SOMEBODY), "--regid", str(_SOMEBODY), "--clear-groups"]
    return ["setpriv", *user, "--inh-caps", _RIGHT, "--ambient-caps", _RIGHT, *command]


@contextmanager
def reachable_folder() -> Iterator[Path]:
    """A folder that everybody can reach; those of pytest are for their owner alone."""
    with tempfile.TemporaryDirectory(prefix="course-kit-test-") as made:
        Path(made).chmod(0o755)
        yield Path(made)


def give(folder: Path) -> None:
    """Make it theirs, with all that is in it."""
    if os.geteuid() == 0:
        for path in (folder, *_inside(folder)):
            os.chown(path, _SOMEBODY, _SOMEBODY, follow_symlinks=False)


def forbid_writing(folder: Path, *, forbid: bool = True) -> None:
    """Make a folder read-only, with all that is in it; or writable again."""
    for path in (folder, *_inside(folder)):
        if not path.is_symlink():
            mode = stat.S_IMODE(path.stat().st_mode)
            path.chmod(mode & ~0o222 if forbid else mode | stat.S_IWUSR)


def _inside(folder: Path) -> Iterator[Path]:
    """What is in it; links are not followed."""
    for inner, folders, files in os.walk(folder):
        yield from (Path(inner, name) for name in (*folders, *files))
