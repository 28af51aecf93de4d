"""What of the course is whose: the lists in edition.toml, from which the student edition is built."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from enum import Enum
from pathlib import Path, PurePosixPath

from course_kit.grading.errors import GradingError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

LIST = Path(__file__).with_name("edition.toml")


class Owner(Enum):
    """Who a file is for."""

    STUDENTS = "students"
    INSTRUCTORS = "instructors"
    UNDECIDED = "undecided"  # on no list: somebody has to say


@dataclass(frozen=True)
class Parts:
    """Files and folders of the course, as paths relative to its folder."""

    students: frozenset[str]  # what the student edition is made of
    instructors: frozenset[str]  # what is left out on purpose

    def owner(self, name: str) -> Owner:
        """Who a file is for; the longest path on the lists decides."""
        path = PurePosixPath(name)
        for part in map(str, (path, *path.parents)):
            if part in self.instructors:
                return Owner.INSTRUCTORS
            if part in self.students:
                return Owner.STUDENTS
        return Owner.UNDECIDED


def load(path: Path = LIST) -> Parts:
    """Read the lists."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        parts = Parts(*(frozenset(map(_path, table[owner.value])) for owner in (Owner.STUDENTS, Owner.INSTRUCTORS)))
    except (OSError, ValueError, KeyError, TypeError) as problem:
        what = f"the list '{problem.args[0]}' is missing" if isinstance(problem, KeyError) else problem
        raise GradingError(f"{path} cannot be used: {what}.") from problem
    if both := sorted(parts.students & parts.instructors):
        raise GradingError(f"{path} cannot be used: {', '.join(both)} stands on both lists.")
    return parts


def _path(name: object) -> str:
    if not isinstance(name, str) or not name:
        raise ValueError(f"{name!r} is not a path")
    return str(PurePosixPath(name))
