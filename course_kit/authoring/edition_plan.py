"""What the student edition will hold, decided before anything is written: each file, and why others stay out.

Files that git does not know stay out, as nobody has said that they belong to the course. Of an exercise only the files
go in that it is known to need, as they were committed: a file of one that git calls changed may hold its solution. It
needs its exercise.toml, starter and notebook, its checks with the modules beside them that they import, its interfaces
and pictures. That holds for exercises of other folders, too, and for what goes into an autograder.
"""

from __future__ import annotations

import ast
import os
import subprocess
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

import msgspec

from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.grading.model.exercise_folders import INTERFACES, TOML
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator


README = Path(__file__).parent / "student" / "README.md"
LIST = Path(__file__).with_name("edition.toml")
ANSWER = "answer"  # a cell with this tag is the answer to a demo; it belongs to the instructor
INSTRUCTOR = "instructor"  # one with this tag speaks to whoever shows it
_EXERCISES = "exercises"
_PICTURES = (".png", ".svg", ".jpg", ".jpeg", ".gif")
_KINDS = (".msg", ".srv", ".action")


class Parts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Files and folders of the course, as paths relative to its folder."""

    students: frozenset[str]  # what the student edition is made of
    instructors: frozenset[str]  # what is left out on purpose

    def owner(self, name: str) -> str:
        """Who a file is for: "students" or "instructors", by the longest path on the lists; "" if it is on none."""
        path = PurePosixPath(name)
        for part in map(str, (path, *path.parents)):
            if part in self.instructors:
                return "instructors"
            if part in self.students:
                return "students"
        return ""


def read_parts() -> Parts:
    """Read the lists in edition.toml."""
    return msgspec.toml.decode(LIST.read_bytes(), type=Parts)


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
    # the exercises of other folders that go in, and where they lie
    added: dict[str, Path] = field(default_factory=dict)
    solutions: dict[str, Path] = field(default_factory=dict)  # by exercise the file of its solution

    @property
    def left_out(self) -> list[str]:
        """Every file that stays out, sorted."""
        return sorted({*self.instructors, *self.undecided, *self.untracked})


def plan_edition(root: Path, without: Collection[str] = ()) -> EditionPlan:
    """Decide what goes into the student edition."""
    found, parts = list_course_files(root), read_parts()
    made = EditionPlan()
    of_exercises: dict[str, list[str]] = {}
    for name in sorted(found.known | found.new):
        owner = parts.owner(name)
        if owner != "students":
            (made.instructors if owner == "instructors" else made.undecided).append(name)
        elif name not in found.known:
            made.untracked.append(name)
        elif exercise_id := _exercise_of(name):
            of_exercises.setdefault(exercise_id, []).append(name)
        else:
            made.files[name] = root / name
    added = added_exercises()
    _require_all(without, {*of_exercises, *added})
    made.changed = sorted(name for name in found.changed if parts.owner(name) == "students")
    _require_pristine([name for name in made.changed if name.startswith(f"{_EXERCISES}/")], without)
    for exercise_id, names in of_exercises.items():
        if exercise_id in without:
            made.instructors += names
            made.unwanted.append(exercise_id)
        elif any(name.endswith(f"/{exercise_id}/{TOML}") for name in names):
            needed = _put(made, load_exercise(exercise_id, root / _EXERCISES), names)
            made.instructors += [name for name in names if name not in needed]
        else:
            made.files.update({name: root / name for name in names})
    made.unwanted += [name for name in added if name in without]
    for exercise in (load_exercise(name) for name in added if name not in without):
        _put(made, exercise, carried_files(exercise))
        made.added[exercise.id] = exercise.folder
    made.files["README.md"] = README
    return made


def _put(made: EditionPlan, exercise: Exercise, names: Collection[str]) -> dict[str, Path]:
    """Put an exercise in, of these files those that it is known to need; returns all of the latter."""
    needed = carried_files(exercise)
    made.files.update({name: path for name, path in needed.items() if name in names})
    (made.drills if exercise.practice else made.exercises).append(exercise.id)
    made.solutions[exercise.id] = exercise.solution
    return needed


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
    """Learners work in their own folder, so what differs from the commit may be somebody's answer."""
    if wrong := [name for name in changed if _exercise_of(name) not in without]:
        raise GradingError(
            f"Git calls exercises changed, and students would get them as they are: {', '.join(wrong)}. "
            "Take the changes back with git restore, commit them, or leave the exercise out with --without."
        )


@dataclass(frozen=True)
class CourseFiles:
    """The files of a course's folder, as paths relative to it."""

    known: frozenset[str]  # those that git knows and that are there
    new: frozenset[str]  # those that git neither tracks nor ignores
    changed: frozenset[str]  # those that differ from the last commit, also those that are gone


def list_course_files(root: Path) -> CourseFiles:
    """The files of the course in `root`, by git, which alone can tell them from what somebody has left there."""
    why = "" if (root / ".git").exists() else "this folder is no clone"
    try:
        known, new = _git(root, "ls-files"), _git(root, "ls-files", "--others", "--exclude-standard")
        changed = _git(root, "diff", "--name-only", "HEAD")
    except FileNotFoundError:
        why = "git is not installed"
    except subprocess.CalledProcessError as problem:
        why = why or problem.stderr.decode(errors="replace").strip().partition("\n")[0].removeprefix("fatal: ")
    if why:
        raise GradingError(
            f"Git could not be asked which files belong to the course: {why}. Make the student edition in a clone of "
            "the course, with git installed."
        )
    return CourseFiles(frozenset(name for name in known if (root / name).is_file()), new, changed)


def _git(root: Path, *arguments: str) -> frozenset[str]:
    """The names that git lists."""
    listed = subprocess.run(["git", *arguments, "-z"], cwd=root, capture_output=True, check=True)
    return frozenset(name for name in os.fsdecode(listed.stdout).split("\0") if name)


def carried_files(exercise: Exercise) -> dict[str, Path]:
    """The files of an exercise, by the names they have in a course's folder."""
    folder = exercise.folder
    found = {folder / TOML, *(folder / name for name in exercise.starters), *_checks(exercise)}
    found |= {path for path in (folder / INTERFACES).rglob("*") if path.suffix in _KINDS}
    found |= {path for path in folder.glob("*") if path.suffix.lower() in _PICTURES}
    place = exercise_folders.path_below(folder)
    return {f"{_EXERCISES}/{place}/{path.relative_to(folder).as_posix()}": path for path in sorted(found)}


def added_exercises() -> list[str]:
    """The ids of the exercises that lie in other folders, those too that the course has itself."""
    found = exercise_folders.find_exercises().folders
    return sorted(name for name, places in found.items() if any(map(exercise_folders.is_added, places)))


def _checks(exercise: Exercise) -> set[Path]:
    """The exercise's file of checks and what that imports from beside it, in any number of steps."""
    found: set[Path] = set()
    waiting = [exercise.folder / exercise.written_grader]  # a module of the kit is no file there
    while waiting:
        path = waiting.pop()
        if path not in found and path.is_file():
            found.add(path)
            waiting += [path.parent / name for name in _list_imported_files(path)]
    return found


def _list_imported_files(path: Path) -> Iterator[str]:
    """The files that `from .module import ...` and `from . import module` of a file may name."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.ImportFrom) and node.level == 1:
            yield from ([f"{node.module}.py"] if node.module else [f"{alias.name}.py" for alias in node.names])


def has_answers(notebook: Any) -> bool:
    """Whether a notebook has cells of the instructor."""
    return any(_is_instructors(cell) for cell in notebook.cells)


def remove_answers(notebook: Any) -> Any:
    """A notebook without the cells of the instructor; the others are numbered anew."""
    notebook.cells = [cell for cell in notebook.cells if not _is_instructors(cell)]
    number_anew(notebook)
    return notebook


def number_anew(notebook: Any) -> None:
    """Number the cells that have been run from 1, as a fresh kernel would; the others stay without a number."""
    run = [cell for cell in notebook.cells if cell.cell_type == "code" and cell.execution_count is not None]
    for number, cell in enumerate(run, start=1):
        cell.execution_count = number
        for output in cell.outputs:
            if output.output_type == "execute_result":
                output.execution_count = number


def _is_instructors(cell: Any) -> bool:
    return not {ANSWER, INSTRUCTOR}.isdisjoint(cell.metadata.get("tags", []))
