"""What can be wrong with the machine or the folder, as sentences for people."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path

SIZES = {"wheels": "about 500 MB", "jazzy": "about 250 MB"}  # of an environment in use; a sourced ROS brings the rest
_FULL = (errno.ENOSPC, errno.EDQUOT)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)


class SetUpError(RuntimeError):
    """The set-up cannot be done; the text is for the user."""


def say(text: str) -> None:
    """Tell the user something, beside the output of the command."""
    print(f"course: {text}", file=sys.stderr, flush=True)


def describe(error: OSError, root: Path, kind: str) -> str:
    """An error of the operating system as sentences: what happened, why, what to do."""
    reason = error.strerror or str(error)
    if error.errno in _FULL:
        return (
            f"The disk is full. The course needs {SIZES[kind]} in {root}. Free some space, then run the same command "
            "again."
        )
    if error.errno in _FORBIDDEN:
        return (
            f"The course must be set up in {root}, but this folder is not writable ({reason}). Copy the folder to a "
            "place where you may write. Or ask its owner to run 'COURSE_PYTHON=/usr/bin/python3 ./course lab' once, "
            "with a Python that you can run, too: then it works for you."
        )
    where = f": {error.filename}" if error.filename else ""
    return f"The set-up failed ({reason}{where}). Fix this, then run the same command again."


def require_usable(root: Path, environments: Path) -> None:
    """Look whether environments can live in the course's folder, and make the folder for them."""
    if os.statvfs(root).f_flag & os.ST_NOEXEC:
        raise SetUpError(
            f"The folder {root} is on a file system that lets no programs run (mounted 'noexec'), so ROS 2 could not "
            "be loaded from it. Move the course's folder to another place, such as your home directory."
        )
    environments.mkdir(exist_ok=True)
    if not os.access(environments, os.W_OK | os.X_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def require_wheels(folder: str) -> None:
    """Look whether there are wheels in the folder to install from.

    Args:
        folder: as an absolute path; "" to use the network.
    """
    if folder and not any(Path(folder).glob("*.whl")):
        raise SetUpError(
            f"There are no wheels in {folder}, which --find-links or COURSE_FIND_LINKS names. An instructor's copy "
            "of the course makes a folder of them, where there is a network: `./course bundle DIR`."
        )
