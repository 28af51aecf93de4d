"""How learning platforms lay out what was handed in: one rule each, from a path to a student.

Rules, as an instructor sees them:

- **canvas** ("Download Submissions"): `doejane_LATE_12345_67890_answer.py`. The student is Canvas's user number, 12345.
- **moodle** ("Download all submissions"): `Jane Doe_4711_assignsubmission_file_/answer.py`, or the same without the
  folder. The student is the participant's number, 4711.
- **nbgrader** (the `submitted` folder): `submitted/jane/assignment/answer.ipynb`. The student is `jane`.
- **github** (`gh classroom clone student-repos`): `assignment-submissions/assignment-jane/answer.py`. The student is
  the login, `jane`; a clone in a folder of another name gives its whole name.
- **folders**: `jane/answer.py`. The student is the first folder.
- **files**: `jane.py`, or `jane_<exercise>.py`. The student is the file's name without that ending.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_CANVAS = re.compile(r"(?P<name>[^_/]+)_(?P<late>LATE_)?(?P<user>\d+)_(?P<submission>\d+)_(?P<file>[^/]+)")
_MOODLE = re.compile(r"(?P<name>[^/]+?)_(?P<number>\d+)_assignsubmission_(?:file|onlinetext)_?/?(?P<file>[^/]*.*)")
_CANVAS_ATTEMPT = re.compile(r"-(\d+)(?=\.\w+$)")
_GITHUB_PARENT = "-submissions"
_NBGRADER_ROOT = "submitted"
_NBGRADER_DEPTH = 3  # student/assignment/file


@dataclass(frozen=True)
class Found:
    """Who a file is from.

    Attributes:
        student: their identifier.
        file: the file's name as they gave it.
        name: their own name, where it can be told.
        late: marked as late by the platform.
        attempt: of several under one name, the higher number is the newer one.
        platform: identifiers for the way back, see `Entry.platform`.
    """

    student: str
    file: str
    name: str = ""
    late: bool = False
    attempt: int = 0
    platform: dict[str, str] = field(default_factory=dict)


def read_canvas(path: str) -> Found | None:
    """A file of Canvas's archive."""
    match = _CANVAS.fullmatch(PurePosixPath(path).name)
    if match is None:
        return None
    attempt = _CANVAS_ATTEMPT.search(match["file"])
    return Found(
        student=match["user"],
        file=_CANVAS_ATTEMPT.sub("", match["file"]),
        name=match["name"],
        late=bool(match["late"]),
        attempt=int(attempt[1]) if attempt else 0,
        platform={"canvas_user": match["user"], "canvas_submission": match["submission"]},
    )


def read_moodle(path: str) -> Found | None:
    """A file of Moodle's archive."""
    for start in range(len(PurePosixPath(path).parts)):
        rest = "/".join(PurePosixPath(path).parts[start:])
        match = _MOODLE.fullmatch(rest)
        if match is not None and match["file"]:
            number = match["number"]
            platform = {"moodle_participant": number}
            return Found(number, PurePosixPath(match["file"]).name, match["name"], platform=platform)
    return None


def read_nbgrader(path: str) -> Found | None:
    """A file of nbgrader's folder of submissions."""
    parts = PurePosixPath(path).parts
    if _NBGRADER_ROOT in parts:
        parts = parts[parts.index(_NBGRADER_ROOT) + 1 :]
    if len(parts) < _NBGRADER_DEPTH:
        return None
    return Found(parts[0], parts[-1], platform={"nbgrader_assignment": parts[1]})


def read_github(path: str) -> Found | None:
    """A file of a repository that GitHub Classroom's command has cloned."""
    parts = PurePosixPath(path).parts
    for number, part in enumerate(parts[:-2]):
        if part.endswith(_GITHUB_PARENT):
            slug = part.removesuffix(_GITHUB_PARENT)
            login = parts[number + 1].removeprefix(f"{slug}-")
            return Found(login, parts[-1], platform={"login": login})
    if len(parts) > 1:
        return Found(parts[0], parts[-1], platform={"login": parts[0]})
    return None


def read_folders(path: str) -> Found | None:
    """A file in a folder that is named after the student."""
    parts = PurePosixPath(path).parts
    return Found(parts[0], parts[-1]) if len(parts) > 1 else None


def read_files(path: str) -> Found | None:
    """A file that is named after the student; the exercise's name at its end is taken off by `intake`."""
    parts = PurePosixPath(path).parts
    return Found(PurePosixPath(path).stem, parts[-1]) if len(parts) == 1 else None


LAYOUTS: dict[str, Callable[[str], Found | None]] = {
    "canvas": read_canvas,
    "moodle": read_moodle,
    "nbgrader": read_nbgrader,
    "github": read_github,
    "folders": read_folders,
    "files": read_files,
}


def recognise(paths: Sequence[str]) -> str:
    """The layout that fits a set of paths: the name of one of `LAYOUTS`."""
    if not paths:
        return "folders"
    parts = [PurePosixPath(path).parts for path in paths]
    if 2 * sum(read_canvas(path) is not None for path in paths) > len(paths):
        return "canvas"
    if any(read_moodle(path) for path in paths):
        return "moodle"
    if any(_NBGRADER_ROOT in one[:-_NBGRADER_DEPTH] for one in parts) or _has_timestamps(paths):
        return "nbgrader"
    if any(part.endswith(_GITHUB_PARENT) for one in parts for part in one[:-2]) or _has_repositories(parts):
        return "github"
    return "files" if 2 * sum(len(one) == 1 for one in parts) > len(parts) else "folders"


def _has_timestamps(paths: Sequence[str]) -> bool:
    return any(PurePosixPath(path).name == "timestamp.txt" and path.count("/") >= _NBGRADER_DEPTH - 1 for path in paths)


def _has_repositories(parts: Sequence[tuple[str, ...]]) -> bool:
    return any(".git" in one[1:] for one in parts)
