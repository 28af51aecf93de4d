"""Where exercises lie: in the course's own folder, and in any that somebody has added.

`--exercises DIR` and the variable COURSE_EXERCISES each add a folder: an exercise, or a folder of exercises. Here is
found where they are; nothing is read.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.interfaces.sources import path_with

if TYPE_CHECKING:
    from collections.abc import Iterable

VARIABLE = "COURSE_EXERCISES"
TOML = "exercise.toml"
DRILLS = "drills"  # a folder of exercises for practice, in the course's own folder of exercises
INTERFACES = "interfaces"  # in an exercise's folder: package/kind/Name.kind
SOLUTIONS = "solutions"  # beside the course's own folder of exercises, in folders named as these
PROOF = "proof"  # in an exercise's folder, too: what proves its grader
_OPTION = "--exercises"


class FoundExercises(NamedTuple):
    """What lies in the folders."""

    folders: dict[str, list[Path]]  # by id those of the exercise; several where that id is there more than once
    drills: dict[str, list[Path]]  # the course's own, by id as well
    problems: list[str]  # what is wrong with the folders that were added, a sentence each


def course_folder() -> Path | None:
    """The course's own folder of exercises; None where only the package is installed."""
    root = environment.course_files()
    return None if root is None or not (root / "exercises").is_dir() else root / "exercises"


def is_added(folder: Path) -> bool:
    """Whether an exercise's folder is none of the course's own."""
    own = course_folder()
    return own is None or folder.parent not in (own, own / DRILLS)


def in_course(folder: Path, name: str) -> str:
    """A file of an exercise's folder as a path below the course's folder; empty for an exercise that was added."""
    own = course_folder()
    if own is None or is_added(folder):
        return ""
    return (folder / name).relative_to(own.parent).as_posix()


def path_below(folder: Path) -> Path:
    """Where an exercise lies in a folder of exercises: under its id, or among the drills."""
    return Path(DRILLS, folder.name) if folder.parent.name == DRILLS else Path(folder.name)


def find_exercises(folder: Path | None = None) -> FoundExercises:
    """The exercises in a folder; without one the course's own, and those that were added."""
    own, named = (course_folder(), _entries()) if folder is None else (folder, [])
    problems = [_explain_nothing_found(entry, VARIABLE) for entry in named if not _exercises(entry)]
    if own is None and not named:
        problems = ["There is no exercises folder here. Run this from a clone of the course."]
    added = [exercise for entry in named for exercise in _exercises(entry)]
    here, drills = (_below(own), _below(own / DRILLS)) if own else ([], [])
    return FoundExercises(_by_id([*here, *added]), _by_id(drills), problems)


def add_exercise_folder(folders: Iterable[str]) -> None:
    """Add folders for this process and all that it starts."""
    for named in folders:
        folder = Path(os.path.abspath(os.path.expanduser(named)))  # noqa: PTH100, PTH111 - as typed, links kept
        if not _exercises(folder):
            raise GradingError(_explain_nothing_found(folder, _OPTION))
        os.environ[VARIABLE] = os.pathsep.join(filter(None, [os.environ.get(VARIABLE, ""), str(folder)]))


def interface_path() -> str:
    """COURSE_KIT_INTERFACE_PATH for a learner's programs: with the interfaces that exercises bring with them."""
    folders = (str(folder / INTERFACES) for places in find_exercises().folders.values() for folder in places)
    return path_with(*filter(os.path.isdir, folders))


def added_exercises() -> list[Path]:
    """The folders of all exercises that were added."""
    return [exercise for folder in _entries() for exercise in _exercises(folder)]


def _entries() -> list[Path]:
    named = os.environ.get(VARIABLE, "").split(os.pathsep)
    return [Path(os.path.expanduser(entry)) for entry in named if entry]  # noqa: PTH111 - of a user nobody knows: as it is


def _exercises(folder: Path) -> list[Path]:
    """A folder itself if it is an exercise, else those in it; a relative name means another in each place, and none."""
    with suppress(OSError):  # a folder of somebody else's
        if folder.is_absolute():
            return [folder] if (folder / TOML).is_file() else _below(folder)
    return []


def _below(folder: Path) -> list[Path]:
    return [toml.parent for toml in sorted(folder.glob(f"*/{TOML}"))]


def _by_id(exercises: Iterable[Path]) -> dict[str, list[Path]]:
    """Folders of exercises by their names; one that is named twice counts once."""
    found: dict[str, list[Path]] = {}
    for exercise in exercises:
        known = found.setdefault(exercise.name, [])
        if not any(map(exercise.samefile, known)):
            known.append(exercise)
    return found


def _explain_nothing_found(folder: Path, named_by: str) -> str:
    if not folder.is_absolute():
        return f"{named_by} names the folder {folder}, which is ignored. Write its whole path, from / on."
    if not folder.is_dir():
        return f"There is no folder {folder}, which {named_by} names."
    return f"There is no exercise in {folder}, which {named_by} names: no {TOML}, neither in it nor in a folder in it."
