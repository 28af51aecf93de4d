"""When a submission was handed in, as far as anything but a student's own file times tells it.

In this order: what the platform told, as Gradescope's list does; `timestamp.txt` where nbgrader writes it, and nowhere
else, for there it is the student's own; the last commit of a clone that changed the file. A student can set the time of
a commit; `git push` leaves none in a clone.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from contextlib import suppress
from datetime import datetime, timezone
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from datetime import tzinfo

    from course_kit.classroom.records import Entry

STAMP = "timestamp.txt"
SUBMITTED_AT, ASSIGNMENT = "submitted_at", "nbgrader_assignment"  # see `Entry.platform`
_LONGEST_STAMP = 200  # bytes
_GIT_S = 10.0
# Git reads an object of a stranger's as a whole, however large it unpacks.
_WITHIN_LIMITS = 'ulimit -d 262144 && ulimit -t 10 && exec "$0" "$@"'
_STAMP = re.compile(r"(?P<time>\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d(\.\d{1,6})?)?)\s*(?P<zone>[\w/+:-]*)", re.ASCII)
_COMMIT = re.compile(r"[0-9a-f]{40}([0-9a-f]{24})?\Z")
_REFERENCE = re.compile(r"refs/[\w./+@-]{1,200}\Z", re.ASCII)
_OFFSET = re.compile(r"[+-]\d\d:?\d\d\Z")
_MOST_BYTES = 1 << 20  # of a file of git's that is read


def submitted(root: Path, entry: Entry, zone: tzinfo | None = None) -> datetime | None:
    """When an entry was handed in, with its zone; None where nothing tells."""
    told = entry.platform.get(SUBMITTED_AT, "")
    if told and (moment := read_stamp(told, zone)):
        return moment
    source = PurePosixPath(entry.source)
    stamps = (_read_text(root / folder / STAMP, _LONGEST_STAMP) for folder in _assignment_folders(entry, source))
    stamp = next((one for one in stamps if one is not None), "")
    return read_stamp(stamp, zone) or _committed(root, source)


def _assignment_folders(entry: Entry, source: PurePosixPath) -> Iterator[PurePosixPath]:
    """Where nbgrader writes its stamp, if that is who collected."""
    assignment = entry.platform.get(ASSIGNMENT)
    return (folder for folder in reversed(source.parents) if assignment and one_line(folder.name) == assignment)


def read_stamp(text: str, zone: tzinfo | None = None) -> datetime | None:
    """What nbgrader has noted: `2026-11-20 22:59:00.000000 UTC`; None where its zone is not known."""
    match = _STAMP.fullmatch(text.strip())
    if match is None:
        return None
    try:
        moment = datetime.fromisoformat(match["time"].partition(".")[0])  # whole seconds, as all Pythons read them
    except ValueError:
        return None
    return _in_zone(moment, match["zone"], zone)


def _in_zone(moment: datetime, name: str, zone: tzinfo | None) -> datetime | None:
    if name in ("", "UTC", "GMT", "Z"):
        return moment.replace(tzinfo=timezone.utc)
    if _OFFSET.match(name):
        return datetime.fromisoformat(f"{moment.isoformat()}{name[:3]}:{name[-2:]}")
    if zone is not None and (local := moment.replace(tzinfo=zone)).tzname() == name:
        return local
    with suppress(ZoneInfoNotFoundError, ValueError, OSError):
        return moment.replace(tzinfo=ZoneInfo(name))
    return None


def _committed(root: Path, source: PurePosixPath) -> datetime | None:
    """When the last commit in a clone changed the file."""
    for depth in range(len(source.parts) - 1, 0, -1):
        clone = root.joinpath(*source.parts[:depth])
        if (clone / ".git").is_dir() and not (clone / ".git").is_symlink():
            commit = _head(clone / ".git")
            return _time_of(clone / ".git" / "objects", commit, "/".join(source.parts[depth:])) if commit else None
    return None


def _head(git: Path) -> str:
    """The commit that is checked out; empty where it cannot be told."""
    text = (_read_text(git / "HEAD") or "").strip()
    if not text.startswith("ref: "):
        return text if _COMMIT.match(text) else ""
    reference = text.removeprefix("ref: ")
    if not _REFERENCE.match(reference) or ".." in reference:
        return ""
    commit = (_read_text(git / reference) or "").strip()
    if not commit:
        lines = (_read_text(git / "packed-refs") or "").splitlines()
        commit = next((line.split()[0] for line in lines if line.endswith(f" {reference}")), "")
    return commit if _COMMIT.match(commit) else ""


def _time_of(objects: Path, commit: str, path: str) -> datetime | None:
    if objects.is_symlink():
        return None
    with tempfile.TemporaryDirectory(prefix="course-kit-git-") as ours:
        variables = {
            "GIT_OBJECT_DIRECTORY": str(objects.absolute()),
            "GIT_CONFIG_NOSYSTEM": "1",
            "GIT_CONFIG_GLOBAL": os.devnull,
            "GIT_LITERAL_PATHSPECS": "1",
            "GIT_NO_LAZY_FETCH": "1",
            "GIT_TERMINAL_PROMPT": "0",
            "HOME": ours,
        }
        form = ["--object-format=sha256"] if len(commit) > 40 else []  # noqa: PLR2004 - digits of SHA-1
        told = _git(["init", "--bare", "--quiet", "--template=", *form, ours], variables={"HOME": ours})
        if told is not None:
            told = _git(["--git-dir", ours, "log", "-1", "--format=%cI", commit, "--", path], variables)
    if not told:
        return None
    with suppress(ValueError):
        return datetime.fromisoformat(told.strip().replace("Z", "+00:00"))
    return None


def _git(arguments: list[str], variables: Mapping[str, str]) -> str | None:
    """What git prints; None where there is no git, or it fails, or takes too long or too much memory."""
    usual = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    try:
        done = subprocess.run(
            ["/bin/sh", "-c", _WITHIN_LIMITS, "git", *arguments],
            env={**usual, **variables},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_GIT_S,
            check=False,
        )
    except (OSError, subprocess.SubprocessError, ValueError):
        return None
    return done.stdout if done.returncode == 0 else None


def _read_text(path: Path, most: int = _MOST_BYTES) -> str | None:
    """A small ordinary file of a stranger's; None where there is none."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError):
        return None
    with os.fdopen(descriptor, "rb") as file:
        try:
            return file.read(most).decode(errors="replace")
        except OSError:  # a folder, say
            return None
