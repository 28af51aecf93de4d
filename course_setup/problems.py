"""What can be wrong with the machine or the folder, as sentences for people."""

from __future__ import annotations

import errno
import os
import secrets
import sys
from pathlib import Path

_SIZES_MB = {"wheels": 500, "jazzy": 250}  # of an environment in use; a sourced ROS brings the rest
_FULL = (errno.ENOSPC, errno.EDQUOT)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)
_FULL_MB = 20  # an installer that found no room has left less than this


class SetUpError(RuntimeError):
    """The set-up cannot be done; the text is for the user."""


def say(text: str) -> None:
    """Tell the user something, beside the output of the command."""
    print(f"course: {text}", file=sys.stderr, flush=True)


def size(kind: str) -> str:
    """How large an environment of this kind is, in words."""
    return f"about {_SIZES_MB[kind]} MB"


def describe(error: OSError, root: Path, kind: str) -> str:
    """An error of the operating system as sentences: what happened, why, what to do."""
    reason = error.strerror or str(error)
    if error.errno in _FULL:
        return disk_full(root, kind)
    if error.errno in _FORBIDDEN:
        return (
            f"The folder {root} cannot be written to ({reason}), but the course is set up inside it. Copy the folder "
            "to a place where you may write; or have its owner run './course lab' once, then it works for you, too."
        )
    where = f": {error.filename}" if error.filename else ""
    return f"The set-up failed ({reason}{where}). Fix this, then run the same command again."


def disk_full(root: Path, kind: str) -> str:
    """The sentence for a disk, or a quota, without room."""
    return (
        f"The disk is full. The course needs {size(kind)} in {root}. Free some space, then run the same command again."
    )


def unfinished(what: str, source: str, root: Path, kind: str) -> str:
    """What to say of a step that failed, after its installer has said why in words of its own.

    Args:
        what: the beginning of the sentence, such as "the installation did not finish".
        source: a sentence about where the step gets what it needs.
        root: the course's folder.
        kind: that of the environment, "wheels" or "jazzy".
    """
    status = os.statvfs(root)
    free = status.f_bavail * status.f_frsize // 2**20
    if free < _FULL_MB:
        return f"{what}. {disk_full(root, kind)}"
    room = f" Only {free} MB are free, but the course needs {size(kind)}." if free < _SIZES_MB[kind] else ""
    return f"{what}; the lines above say why. {source}{room} Then run the same command again."


def require_usable(root: Path, environments: Path) -> None:
    """Look whether environments can live in the course's folder, and make the folder for them.

    Raises:
        SetUpError: its name or its file system will not do.
        OSError: it cannot be written.
    """
    try:
        os.fsencode(root).decode("utf-8")
    except UnicodeDecodeError:
        raise SetUpError(
            f"The name of the folder {os.fsencode(root)!r} is not valid UTF-8, as Jupyter needs it. Rename the folder "
            "without letters like these, and run this again."
        ) from None
    if os.statvfs(root).f_flag & os.ST_NOEXEC:
        raise SetUpError(
            f"The folder {root} is on a file system that lets no programs run (mounted 'noexec'), so ROS 2 could not "
            "be loaded from it. Move the course's folder to another place, such as your home directory."
        )
    environments.mkdir(exist_ok=True)
    _require_links(root, environments)


def require_wheels(folder: str) -> None:
    """Look whether there are wheels in the folder to install from.

    Args:
        folder: as an absolute path; "" where the network is to be used.

    Raises:
        SetUpError: there are none.
    """
    if folder and not any(Path(folder).glob("*.whl")):
        raise SetUpError(
            f"There are no wheels in {folder}, which --find-links or COURSE_FIND_LINKS names. An instructor's copy "
            "of the course makes a folder of them, where there is a network: `./course bundle DIR`."
        )


def _require_links(root: Path, environments: Path) -> None:
    probe = environments / f"link-{secrets.token_hex(3)}"
    try:
        probe.symlink_to("lock")
    except OSError as error:
        if error.errno in (errno.EPERM, errno.ENOSYS, errno.EOPNOTSUPP):
            raise SetUpError(
                f"The file system of {root} has no symbolic links (a USB stick, or a folder shared with Windows?), and "
                "Python environments need them. Move the course's folder to a disk of this system, such as your home "
                "directory."
            ) from None
        raise
    probe.unlink()
