"""What the student edition will hold, decided before anything is written: each file, and why others stay out.

Files that git does not know stay out, as nobody has said that they belong to the course. Of an exercise only the files
go in that it is known to need, as they were committed: a file of one that git calls changed may hold its solution.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from course_kit.authoring import carried_exercises, course_files
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.ros.names import did_you_mean

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Collection

    from course_kit.authoring.course_files import CourseFiles
    from course_kit.grading.exercise import Exercise

README = Path(__file__).parent / "student" / "README.md"
LIST = Path(__file__).with_name("edition.toml")
_EXERCISES = "exercises"


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


def read_parts(path: Path = LIST) -> Parts:
    """Read the lists in edition.toml."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        parts = Parts(*(frozenset(map(_to_path, table[owner.value])) for owner in (Owner.STUDENTS, Owner.INSTRUCTORS)))
    except (OSError, ValueError, KeyError, TypeError) as problem:
        what = f"the list '{problem.args[0]}' is missing" if isinstance(problem, KeyError) else problem
        raise GradingError(f"{path} cannot be used: {what}.") from problem
    if both := sorted(parts.students & parts.instructors):
        raise GradingError(f"{path} cannot be used: {', '.join(both)} stands on both lists.")
    return parts


def _to_path(name: object) -> str:
    if not isinstance(name, str) or not name:
        raise ValueError(f"{name!r} is not a path")
    return str(PurePosixPath(name))


@dataclass
class EditionPlan:
    """What goes in and what does not, as paths relative to the course's folder."""

    files: dict[str, Path] = field(default_factory=dict)  # what goes in, and from where
    exercises: list[str] = field(default_factory=list)  # the exercises that go in
    drills: list[str] = field(default_factory=list)  # the drills that go in
    instructors: list[str] = field(default_factory=list)  # left out on purpose
    undecided: list[str] = field(default_factory=list)  # left out, because they stand on no list
    untracked: list[str] = field(default_factory=list)  # left out, because git does not know them
    unwanted: list[str] = field(default_factory=list)  # exercises left out, because somebody has asked for it
    changed: list[str] = field(default_factory=list)  # what goes in, or would, and differs from the last commit
    git: str = ""  # why git could not be asked; empty where it answered
    of_exercises: list[str] = field(default_factory=list)  # the files of exercises that are left out
    # the exercises of other folders that go in, and where they lie
    added: dict[str, Path] = field(default_factory=dict)
    solutions: dict[str, Path] = field(default_factory=dict)  # by exercise the file of its solution

    @property
    def left_out(self) -> list[str]:
        """Every file that stays out, sorted."""
        return sorted({*self.instructors, *self.undecided, *self.untracked, *self.of_exercises})


def plan(root: Path, without: Collection[str] = ()) -> EditionPlan:
    """Decide what goes into the student edition."""
    return _Planner(root, course_files.look(root)).plan(without)


class _Planner:
    """Puts each file of a course where it belongs in a plan."""

    def __init__(self, root: Path, found: CourseFiles) -> None:
        self._root = root
        self._found = found
        self._parts = read_parts()
        self._made = EditionPlan(git=found.git)

    def plan(self, without: Collection[str]) -> EditionPlan:
        of_exercises: dict[str, list[str]] = {}
        for name in sorted(self._found.known | self._found.new):
            owner = self._parts.owner(name)
            if owner is Owner.INSTRUCTORS:
                self._made.instructors.append(name)
            elif owner is Owner.UNDECIDED:
                self._made.undecided.append(name)
            elif name not in self._found.known:
                self._made.untracked.append(name)
            elif exercise_id := _exercise_of(name):
                of_exercises.setdefault(exercise_id, []).append(name)
            else:
                self._made.files[name] = self._root / name
        added = carried_exercises.added()
        _require_all(without, {*of_exercises, *added})
        changed = sorted(name for name in self._found.changed if self._parts.owner(name) is Owner.STUDENTS)
        _require_pristine([name for name in changed if name.startswith(f"{_EXERCISES}/")], without)
        for exercise_id, names in of_exercises.items():
            if exercise_id in without:
                self._made.of_exercises += names
                self._made.unwanted.append(exercise_id)
            elif any(name.endswith(f"/{exercise_id}/{exercise_folders.TOML}") for name in names):
                self._put_exercise(exercise.load(exercise_id, self._root / _EXERCISES), names)
            else:
                self._made.files.update({name: self._root / name for name in names})
        for exercise_id in added:
            self._put_added(exercise_id, is_wanted=exercise_id not in without)
        self._made.files["README.md"] = README
        self._made.changed = changed
        return self._made

    def _put_exercise(self, task: Exercise, names: list[str]) -> None:
        needed = carried_exercises.files(task)
        self._made.files.update({name: path for name, path in needed.items() if name in names})
        self._made.instructors += [name for name in names if name not in needed]
        (self._made.drills if task.practice else self._made.exercises).append(task.id)
        self._made.solutions[task.id] = task.solution

    def _put_added(self, exercise_id: str, *, is_wanted: bool) -> None:
        """An exercise of another folder, whose files there are what students get."""
        if not is_wanted:
            self._made.unwanted.append(exercise_id)
            return
        task = exercise.load(exercise_id)
        self._made.exercises.append(exercise_id)
        self._made.added[exercise_id] = task.folder
        self._made.solutions[exercise_id] = task.solution
        self._made.files.update(carried_exercises.files(task))
        self._made.of_exercises += carried_exercises.left_behind(task)


def _exercise_of(name: str) -> str:
    """Whose file this is: the id of an exercise, or nothing."""
    for folder in (f"{_EXERCISES}/{exercise_folders.DRILLS}", _EXERCISES):
        exercise_id, below, _ = name.removeprefix(f"{folder}/").partition("/")
        if name.startswith(f"{folder}/") and below:
            return exercise_id
    return ""


def _require_all(without: Collection[str], known: Collection[str]) -> None:
    for name in without:
        if name not in known:
            guess = did_you_mean(name, sorted(known))
            raise GradingError(f"There is no exercise '{name}' to leave out.{guess}")


def _require_pristine(changed: list[str], without: Collection[str]) -> None:
    """Learners work in a folder of their own, so what differs from the commit may be somebody's answer."""
    if wrong := [name for name in changed if _exercise_of(name) not in without]:
        raise GradingError(
            f"Git calls exercises changed, and students would get them as they are: {', '.join(wrong)}. "
            "Take the changes back with git restore, commit them, or leave the exercise out with --without."
        )
