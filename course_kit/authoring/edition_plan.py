"""What the student edition will hold, decided before anything is written: each file, and why others stay out.

Files that git does not know stay out, as nobody has said that they belong to the course. An exercise is different: its
pristine copy, which only `course_kit.authoring.pristine` makes, says what students shall get. With one it goes in,
whether git knows it or not; without one it stays out, because the working tree may hold its solution.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.authoring import carried_exercises, course_files, parts
from course_kit.authoring.parts import Owner
from course_kit.grading import exercise
from course_kit.grading.errors import GradingError
from course_kit.grading.exercise_folders import DRILLS
from course_kit.learner.workspace import PRISTINE
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection

    from course_kit.authoring.course_files import CourseFiles
    from course_kit.grading.exercise import Exercise

README = Path(__file__).parent / "student" / "README.md"
_EXERCISES, _STARTERS, _TOML = "exercises", "course_kit/starters", "exercise.toml"


@dataclass
class EditionPlan:
    """What goes in and what does not, as paths relative to the course's folder.

    Attributes:
        files: what goes in, and from where.
        exercises: the exercises that go in.
        drills: the drills that go in.
        new_exercises: those of them that git does not know.
        solved: starters that were changed in the working tree; their pristine copies go in instead.
        instructors: left out on purpose.
        undecided: left out, because they stand on no list.
        untracked: left out, because git does not know them.
        without_starter: exercises left out, because there is no pristine copy of their starter.
        unwanted: exercises left out, because somebody has asked for it.
        changed: what goes in, or would, and differs from the last commit.
        git: why git could not be asked; empty where it answered.
        of_exercises: the files of exercises that are left out.
        added: the exercises of other folders that go in, and where they lie.
        solutions: by exercise the file of its solution.
    """

    files: dict[str, Path] = field(default_factory=dict)
    exercises: list[str] = field(default_factory=list)
    drills: list[str] = field(default_factory=list)
    new_exercises: list[str] = field(default_factory=list)
    solved: list[str] = field(default_factory=list)
    instructors: list[str] = field(default_factory=list)
    undecided: list[str] = field(default_factory=list)
    untracked: list[str] = field(default_factory=list)
    without_starter: list[str] = field(default_factory=list)
    unwanted: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)
    git: str = ""
    of_exercises: list[str] = field(default_factory=list)
    added: dict[str, Path] = field(default_factory=dict)
    solutions: dict[str, Path] = field(default_factory=dict)

    @property
    def left_out(self) -> list[str]:
        """Every file that stays out, sorted."""
        return sorted({*self.instructors, *self.undecided, *self.untracked, *self.of_exercises})


def plan(root: Path, without: Collection[str] = ()) -> EditionPlan:
    """Decide what goes into the student edition.

    Args:
        root: the course's folder.
        without: ids of exercises that shall not go in.

    Raises:
        GradingError: there is no such exercise, or a list or an exercise.toml has a mistake.
    """
    return _Planner(root, course_files.look(root)).plan(without)


class _Planner:
    """Puts each file of a course where it belongs in a plan."""

    def __init__(self, root: Path, found: CourseFiles) -> None:
        self._root = root
        self._found = found
        self._parts = parts.load()
        self._made = EditionPlan(git=found.git)

    def plan(self, without: Collection[str]) -> EditionPlan:
        of_exercises: dict[str, list[str]] = {}
        for name in sorted(self._found.known | self._found.new):
            owner = self._parts.owner(name)
            if owner is Owner.INSTRUCTORS:
                self._made.instructors.append(name)
            elif owner is Owner.UNDECIDED:
                self._made.undecided.append(name)
            elif exercise_id := _exercise_of(name):
                of_exercises.setdefault(exercise_id, []).append(name)
            else:
                self._put_known(name)
        added = carried_exercises.added()
        _require_all(without, {*of_exercises, *added})
        for exercise_id, names in of_exercises.items():
            if exercise_id in without:
                self._leave_out(exercise_id, names, self._made.unwanted)
            elif f"{_EXERCISES}/{exercise_id}/{_TOML}" in names:
                self._put_exercise(exercise.load(exercise_id, self._root / _EXERCISES), names)
            elif f"{_EXERCISES}/{DRILLS}/{exercise_id}/{_TOML}" in names:
                self._put_drill(exercise.load(exercise_id, self._root / _EXERCISES), names)
            else:
                self._put_no_exercise(names)
        for exercise_id in added:
            self._put_added(exercise_id, is_wanted=exercise_id not in without)
        self._made.files["README.md"] = README
        self._made.changed = sorted(name for name in self._found.changed if self._parts.owner(name) is Owner.STUDENTS)
        return self._made

    def _put(self, name: str, source: str | None = None) -> None:
        self._made.files[name] = self._root / (source or name)

    def _put_known(self, name: str) -> None:
        if name in self._found.known:
            self._put(name)
        else:
            self._made.untracked.append(name)

    def _leave_out(self, exercise_id: str, names: list[str], where: list[str]) -> None:
        self._made.of_exercises += names
        where.append(exercise_id)

    def _put_no_exercise(self, names: list[str]) -> None:
        """A folder of pictures, say, or starters that are left of an exercise that is gone."""
        for name in names:
            if name.startswith(f"{_STARTERS}/"):
                self._made.of_exercises.append(name)
            else:
                self._put_known(name)

    def _put_drill(self, task: Exercise, names: list[str]) -> None:
        """A drill, whose solution and proof set lie in its folder and stay behind."""
        behind = {Path(path).relative_to(self._root).as_posix() for path in carried_exercises.left_behind(task)}
        self._made.instructors += sorted(behind & set(names))
        own = [name for name in names if name not in behind]
        self._put_exercise(task, own, f"{_EXERCISES}/{DRILLS}/{task.id}")

    def _put_exercise(self, task: Exercise, names: list[str], folder: str = "") -> None:
        folder = folder or f"{_EXERCISES}/{task.id}"
        toml = f"{folder}/{_TOML}"
        starters = {
            f"{folder}/{name}": f"{_STARTERS}/{task.id}/{name}{PRISTINE}" for name in (task.starter, task.notebook)
        }
        if not set(starters.values()) <= set(names):
            self._leave_out(task.id, names, self._made.without_starter)
            return
        (self._made.drills if task.practice else self._made.exercises).append(task.id)
        self._made.solutions[task.id] = task.solution
        self._put(toml)
        for name, pristine in starters.items():
            self._put(pristine)
            self._put(name, pristine)
            if name in names and (self._root / name).read_bytes() != (self._root / pristine).read_bytes():
                self._made.solved.append(name)
        if not self._found.known.issuperset((toml, *starters.values())):
            self._made.new_exercises.append(task.id)
            self._put_grader(task)
        for name in names:
            if name not in self._made.files:
                self._put_known(name)

    def _put_added(self, exercise_id: str, *, is_wanted: bool) -> None:
        """An exercise of another folder, whose starter there is what students get."""
        if not is_wanted:
            self._made.unwanted.append(exercise_id)
            return
        task = exercise.load(exercise_id)
        self._made.exercises.append(exercise_id)
        self._made.added[exercise_id] = task.folder
        self._made.solutions[exercise_id] = task.solution
        self._made.files.update(carried_exercises.files(task))
        for name in (task.starter, task.notebook):
            self._made.files[f"{_STARTERS}/{exercise_id}/{name}{PRISTINE}"] = task.folder / name
        self._made.of_exercises += carried_exercises.left_behind(task)

    def _put_grader(self, task: Exercise) -> None:
        """An exercise that git does not know brings its module of checks, which git may not know either."""
        name = f"{task.grader.replace('.', '/')}.py"
        if name in self._made.untracked:
            self._made.untracked.remove(name)
            self._put(name)


def _exercise_of(name: str) -> str:
    """Whose file this is: the id of an exercise, or nothing."""
    for folder in (f"{_EXERCISES}/{DRILLS}", _EXERCISES, _STARTERS):
        exercise_id, below, _ = name.removeprefix(f"{folder}/").partition("/")
        if name.startswith(f"{folder}/") and below:
            return exercise_id
    return ""


def _require_all(without: Collection[str], known: Collection[str]) -> None:
    for name in without:
        if name not in known:
            guess = did_you_mean(name, sorted(known))
            raise GradingError(f"There is no exercise '{name}' to leave out.{guess}")
