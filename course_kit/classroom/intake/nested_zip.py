"""A zip that a student has handed in: opened once, within the limits of an archive; what goes wrong is theirs alone."""

from __future__ import annotations

import errno
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake.archive import NAMES_OF_ONE, Archive
from course_kit.classroom.intake.combined_listing import moved
from course_kit.classroom.intake.listing import FOLDER, Item, look_through
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path

CONTENTS = ".contents"  # added to a zip's name, of the folder with what was in it
MOST = 3  # zips of one student
_ITS_NAMES_FAULT = (errno.ENAMETOOLONG, errno.EEXIST, errno.ENOTDIR, errno.EILSEQ)


@dataclass(frozen=True)
class Contents:
    """What was in a zip; as `listing.Found` has it."""

    files: tuple[Item, ...] = ()  # the files; programs among them can be read
    tools: tuple[tuple[str, str], ...] = ()  # path and reason of what is nobody's work
    unseen: tuple[tuple[str, str], ...] = ()  # path and reason of what might have been a submission, and cannot be had
    problem: str = ""  # why the zip cannot be opened


def unpack(root: Path, item: Item) -> Contents:
    """Open a student's zip beside itself."""
    folder = f"{item.path}{CONTENTS}"
    try:
        with Archive(root / item.path, root / folder, NAMES_OF_ONE) as archive:
            found = look_through(archive, Item("", FOLDER))
            wanted = [one for one in found.files if one.is_program or len(found.files) == 1]
            problems = archive.fetch(wanted)
            lost = [*found.unseen, *archive.lost]
    except GradingError as problem:
        return Contents(problem=str(problem))
    except OSError as problem:
        if problem.errno not in _ITS_NAMES_FAULT:
            raise
        return Contents(problem=f"it cannot be unpacked: {problem.strerror}")
    return Contents(
        tuple(moved(replace(one, problem=one.problem or problems.get(one.path, "")), folder) for one in found.files),
        tuple((f"{folder}/{path}", reason) for path, reason in found.tools),
        tuple((f"{folder}/{path}" if path else folder, reason) for path, reason in lost),
    )
