"""Exercises of other folders on their way into a student edition or an autograder: which of their files go along.

Only what an exercise is known to need: its exercise.toml, starter and notebook, its checks with the modules beside them
that they import, its interfaces and pictures. Its solution, its proof set and whatever else lies there stay behind.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Exercise, read_exercise_table
from course_kit.grading.model.exercise_folders import INTERFACES, TOML

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


FOLDER = "exercises"
_PICTURES = (".png", ".svg", ".jpg", ".jpeg", ".gif")
_KINDS = (".msg", ".srv", ".action")


def carried_files(exercise: Exercise) -> dict[str, Path]:
    """The files of an exercise, by the names they have in a course's folder."""
    folder = exercise.folder
    found = {folder / TOML, *(folder / name for name in exercise.starters), *_checks(folder)}
    found |= {path for path in (folder / INTERFACES).rglob("*") if path.suffix in _KINDS}
    found |= {path for path in folder.glob("*") if path.suffix.lower() in _PICTURES}
    place = exercise_folders.path_below(folder)
    return {f"{FOLDER}/{place}/{path.relative_to(folder).as_posix()}": path for path in sorted(found)}


def added_exercises() -> list[str]:
    """The ids of the exercises that lie in other folders, those too that the course has itself."""
    found = exercise_folders.find_exercises().folders
    return sorted(name for name, places in found.items() if any(map(exercise_folders.is_added, places)))


def _checks(folder: Path) -> set[Path]:
    """The exercise's file of checks and what that imports from beside it, in any number of steps."""
    found: set[Path] = set()
    waiting = [folder / name for name in _grader_of(folder)]
    while waiting:
        path = waiting.pop()
        if path not in found and path.is_file():
            found.add(path)
            waiting += [path.parent / name for name in _list_imported_files(path)]
    return found


def _grader_of(folder: Path) -> Iterator[str]:
    grader = read_exercise_table(folder).get("grader")
    if isinstance(grader, str) and grader.endswith(".py"):
        yield grader


def _list_imported_files(path: Path) -> Iterator[str]:
    """The files that `from .module import ...` and `from . import module` of a file may name."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            yield from ([f"{node.module}.py"] if node.module else [f"{alias.name}.py" for alias in node.names])
