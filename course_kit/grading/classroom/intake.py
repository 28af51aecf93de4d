"""Finds the submissions in what an instructor has downloaded; whatever is not one is listed, never dropped."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.classroom import archive, layouts
from course_kit.grading.classroom.records import Entry
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.grading.submission import Copy, UnreadableError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.grading.classroom.layouts import Found
    from course_kit.grading.exercise import Exercise

_PROGRAMS = (".py", ".ipynb")
# Written by platforms, editors and tools, not by students; each is one line in the list of what was left.
_FOREIGN_FOLDERS = frozenset({".git", ".github", "__MACOSX", "__pycache__", ".ipynb_checkpoints", ".venv"})
_NAMED, _CALLED_ALIKE, _BY_CONTENT, _ONLY_ONE = 4, 3, 2, 1  # how sure it is that a file is for an exercise


@dataclass(frozen=True)
class Intake:
    """What was handed in.

    Attributes:
        root: the folder the entries' sources are relative to.
        layout: the name of the layout that was recognised.
        entries: the submissions, by student and exercise.
        left: path and reason of every file that is none.
        missing: student and exercise of whoever handed in something else only.
    """

    root: Path
    layout: str
    entries: tuple[Entry, ...]
    left: tuple[tuple[str, str], ...]
    missing: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class _Candidate:
    found: Found
    path: str
    sureness: int
    changed: float

    @property
    def rank(self) -> tuple[int, int, float, str]:
        return (self.sureness, self.found.attempt, self.changed, self.path)


def collect(
    source: Path,
    exercises: Sequence[Exercise],
    workspace: Path,
    layout: str = "auto",
    stopped: Callable[[], bool] = lambda: False,
) -> Intake:
    """Find the submissions.

    For each student and exercise one file is taken: named like the starter or its notebook, else with the exercise's
    id in its name, else one that holds its class, variable or `%%submission` line; with a single exercise also a
    student's only program. Of several the surest, then the newest.

    Args:
        source: a folder or a zip.
        exercises: which exercises were set.
        workspace: where a zip is unpacked.
        layout: a name of `layouts.LAYOUTS`, or "auto" to recognise it.
        stopped: asked now and then whether to stop.

    Raises:
        GradingError: there is no such folder, zip or layout, or nothing in it.
        ReadingStoppedError: somebody has asked to stop.
    """
    if layout != "auto" and layout not in layouts.LAYOUTS:
        raise GradingError(f"There is no layout '{layout}'. There are: auto, {', '.join(layouts.LAYOUTS)}.")
    root, left = _open(source, workspace)
    paths, foreign = _files(root)
    left += foreign
    if not paths:
        raise GradingError(f"There are no files in {source}.")
    name = layouts.recognise(paths + [path for path, _ in foreign]) if layout == "auto" else layout
    students: dict[str, list[tuple[Found, str]]] = {}
    for path in paths:
        found = layouts.LAYOUTS[name](path)
        if found is None:
            left.append((path, f"its name does not follow the layout '{name}'"))
        else:
            found = _without_exercise(found, exercises) if name == "files" else found
            students.setdefault(found.student, []).append((found, path))
    entries: list[Entry] = []
    missing: list[tuple[str, str]] = []
    with Reader(stopped) as reader:
        for student, files in sorted(students.items()):
            found_entries, rest = _entries_of(student, files, exercises, root, reader)
            entries += found_entries
            left += rest
            handed_in = {entry.exercise for entry in found_entries}
            missing += [(student, exercise.id) for exercise in exercises if exercise.id not in handed_in]
    return Intake(root, name, tuple(entries), tuple(sorted(left)), tuple(missing))


def _open(source: Path, workspace: Path) -> tuple[Path, list[tuple[str, str]]]:
    if source.is_dir():
        return source, []
    if source.is_file():
        return workspace, archive.unpack(source, workspace)
    raise GradingError(f"There is no folder or zip {source}.")


def _files(root: Path) -> tuple[list[str], list[tuple[str, str]]]:
    """All files, and the folders of tools that are not looked into."""
    paths, foreign = [], []
    for folder, folders, files in os.walk(root):
        here = Path(folder)
        tools = sorted(_FOREIGN_FOLDERS.intersection(folders))
        foreign += [((here / name).relative_to(root).as_posix(), "a folder of a tool") for name in tools]
        folders[:] = sorted(set(folders) - _FOREIGN_FOLDERS)
        paths += [(here / name).relative_to(root).as_posix() for name in files]
    return sorted(paths), foreign


def _without_exercise(found: Found, exercises: Sequence[Exercise]) -> Found:
    """`jane_temperature_service.py` is jane's; a file that is called like the exercise alone stays as it is."""
    for exercise in exercises:
        student = found.student.removesuffix(exercise.id)
        if student != found.student and (student := student.rstrip(" _.-")):
            return replace(found, student=student)
    return found


def _entries_of(
    student: str, files: list[tuple[Found, str]], exercises: Sequence[Exercise], root: Path, reader: Reader
) -> tuple[list[Entry], list[tuple[str, str]]]:
    """A student's submissions, and the files that are none with the reason."""
    entries = []
    superseded: dict[str, str] = {}
    for exercise in exercises:
        found_ones = _candidates(root, files, exercise, reader, alone=len(exercises) == 1)
        candidates = sorted(found_ones, key=lambda one: one.rank)
        if candidates:
            best = candidates[-1]
            superseded.update((one.path, best.path) for one in candidates[:-1])
            found = best.found
            entries.append(Entry(student, exercise.id, best.path, found.name, found.late, dict(found.platform)))
    taken = {entry.source for entry in entries}
    rest = [
        (path, f"{superseded[path]} was taken" if path in superseded else "it is for none of the exercises")
        for _, path in files
        if path not in taken
    ]
    return entries, rest


def _candidates(
    root: Path, files: list[tuple[Found, str]], exercise: Exercise, reader: Reader, *, alone: bool
) -> Iterator[_Candidate]:
    programs = [path for _, path in files if path.endswith(_PROGRAMS)]
    for found, path in files:
        sureness = _sureness(root / path, found, exercise, reader)
        if not sureness and alone and ([path] == programs or (not programs and len(files) == 1)):
            sureness = _ONLY_ONE  # whatever it is, its student gets a report that says what is wrong with it
        if sureness:
            yield _Candidate(found, path, sureness, _changed(root / path))


def _sureness(path: Path, found: Found, exercise: Exercise, reader: Reader) -> int:
    if not path.name.endswith(_PROGRAMS):
        return 0
    if found.file in (exercise.starter, exercise.notebook):
        return _NAMED
    if exercise.id in found.file.lower():
        return _CALLED_ALIKE
    return _BY_CONTENT if _is_meant_for(path, exercise, reader) else 0


def _is_meant_for(path: Path, exercise: Exercise, reader: Reader) -> bool:
    """Whether a file holds what the exercise asks for; links and special files are not opened."""
    if path.is_symlink():
        return False
    try:
        copy = Copy(path, whole=False)
    except UnreadableError:
        return False
    with copy:
        try:
            return reader.mentions(copy, exercise)
        except (UnreadableError, GradingError):
            return True  # it may be; whoever reads it next says what is wrong with it


def _changed(path: Path) -> float:
    try:
        return path.lstat().st_mtime
    except OSError:
        return 0.0
