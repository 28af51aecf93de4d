"""Where a learner's own files are: in a learner's folder, made from the course the first time they start it.

In a clone it lies inside, where git ignores it: lessons that have been run never make the clone differ from its
commit. Where the course is an installed package, or a folder that belongs to somebody else, it lies in the learner's
home directory. `watch`, `reset` and the like find the files there, or where one stands.
"""

from __future__ import annotations

import os
import shutil
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.grading.reading_answers import Glance
from course_kit.grading.readings import Readings, starter_identities
from course_kit.grading.submission import Copy, UnreadableError
from course_kit.learner import learner_folder
from course_kit.text.console import cannot, tell

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.exercise import Exercise

_COMMAND = "course"
# A student edition comes without it. Students may hand in by git, so git does not ignore their folder there.
_IN_AUTHORS_COURSE = (environment.PACKAGE / "authoring").is_dir()
_AT_ONCE_S = 60.0  # files that one download or one copy wrote are of one age
_LEFT_OUT = shutil.ignore_patterns(
    ".ipynb_checkpoints", "__pycache__", "*.backup-*", f"*.{learner_folder.BESIDE}*", "solution", exercise_folders.PROOF
)


def copy(target: Path | None) -> int:
    """Make a learner's folder, or bring one up to date, and say where it is; 2 where that cannot be done."""
    root = environment.course_files()
    if root is None:
        return cannot("the lessons and exercises are missing in this installation. Install the course again.")
    target = target or _my_folder()
    try:
        target = target.absolute() if target == root / environment.LEARNER_FOLDER else target.resolve()
        if target != root / environment.LEARNER_FOLDER and (target == root or root in target.parents):
            return cannot(f"{target} is inside the course's folder. Name another folder.")
        make_copy(root, target, restore=True)
    except OSError as problem:
        return cannot(f"{problem.filename or target} could not be written: {problem.strerror or problem}.")
    print(f"The lessons and exercises are in {target}. What you have changed there stays as it is.")
    return 0


def make_copy(root: Path, target: Path, *, restore: bool = False) -> None:
    """Make a learner's folder, or bring new versions into one; with `restore` also what the learner has deleted."""
    target.parent.mkdir(parents=True, exist_ok=True)
    course = {
        source.relative_to(root).as_posix(): learner_folder.as_handed_out(source.name, source.read_bytes())
        for source in _files(root)
    }
    for sentence in learner_folder.update(target, course, restore=restore):
        tell(sentence)
    with suppress(OSError):  # a convenience: `course-kit` does the same
        _put_command(target / _COMMAND, root)
    ignored = target / ".gitignore"
    if target.parent == root and _IN_AUTHORS_COURSE and not ignored.exists():
        environment.write_atomically(ignored, "*\n")


def _put_command(command: Path, root: Path) -> None:
    """Have `./course` work in a learner's folder as the lessons say it; a file of the learner's own stays."""
    installed = Path(sys.executable).with_name("course-kit")
    ours = installed if environment.checkout() is None else root / _COMMAND
    if command.is_symlink() or not command.exists():
        command.unlink(missing_ok=True)
        command.symlink_to(ours)


def _my_folder() -> Path:
    """The learner's folder that a command without a path means."""
    return environment.learner_folder() or environment.paths.usual_learner_folder()


def _files(root: Path) -> Iterator[Path]:
    def stop(problem: OSError) -> None:
        raise problem  # what cannot be read is not what the course no longer has

    for name in environment.paths.COPIED:
        for folder, folders, files in os.walk(root / name, onerror=stop):
            left_out = _LEFT_OUT(folder, [*folders, *files])
            folders[:] = [each for each in folders if each not in left_out]
            yield from (Path(folder, each) for each in files if each not in left_out)


def exercise_folder(task: Exercise) -> Path | None:
    """The folder with this user's files of an exercise: found from where they are, else in their learner's folder.

    The course's own where there is no other yet; None where they cannot write that.
    """
    course = task.folder
    here = Path.cwd()
    own = exercise_folders.course_folder()
    around = course if own is None or exercise_folders.is_added(course) else own.parent
    mine = _my_folder()
    if here.is_relative_to(around) and not here.is_relative_to(mine):
        found = None  # within the course: another folder there may hold a file of this name that is no starter
    else:
        found = next((folder for folder in _places(here, task) if _has_one(folder, task)), None)
    if found is not None:
        return found
    copied = mine / "exercises" / exercise_folders.place(course)
    if not exercise_folders.is_added(course) and _has_one(copied, task):
        return copied
    its_own = environment.checkout() is not None or exercise_folders.is_added(course)  # nobody works in a package
    return course if its_own and environment.paths.is_writable(course, make=False) else None


def no_files_of(task: Exercise, verb: str) -> GradingError:
    """What to tell a user of whose files `exercise_folder` knows nothing; `verb` is what they wanted."""
    command = environment.command()
    why = f"There is no {task.starter} of yours here"
    if environment.checkout() is not None:
        why = f"The course's folder is read-only for you, and there is no {task.starter} of yours here"
    return GradingError(
        f"{why}. Make your own copy of the course with {command} copy, or name your file: "
        f"{command} {verb} {task.id} FILE."
    )


def own_file(task: Exercise, verb: str) -> Path:
    """This user's program of an exercise, or its notebook where that is the answer: see `_choose_own`."""
    return _choose_own(task, verb)[0]


def _choose_own(task: Exercise, verb: str) -> tuple[Path, str]:
    """Of program and notebook the one that a class run would grade, and why where both are there."""
    folder = exercise_folder(task)
    if folder is None:
        raise no_files_of(task, verb)
    program, notebook = folder / task.starter, folder / task.notebook
    if not (program.is_file() and notebook.is_file()):
        return (notebook if notebook.is_file() else program), ""
    with Readings() as readings:
        seen = {path: _glance(readings, path, task) for path in (program, notebook)}
    given = starter_identities(task) | {""}  # nobody has begun with these, nor with an empty program
    changed = [path for path, glance in seen.items() if glance.identity not in given]
    fitting = [path for path in changed if seen[path].asked_for]
    if len(changed) == 1 or len(fitting) == 1:
        best = (fitting or changed)[0]
        other = program if best == notebook else notebook
        lacks = "is the starter still" if len(changed) == 1 else f"does not hold {task.class_name or task.variable}"
        return best, f", because {other.name} {lacks}"
    if not changed:
        return program, ""
    best, other = program, notebook
    if notebook.stat().st_mtime > program.stat().st_mtime + _AT_ONCE_S:
        best, other = notebook, program
    named = f"{environment.command()} {verb} {task.id} {shown(other)}"
    return best, f", the newer of your two answers. For the other one: {named}"


def _glance(readings: Readings, path: Path, task: Exercise) -> Glance:
    """What a file looks like; one that cannot be read is graded if it is all there is, and the report says why."""
    with suppress(UnreadableError, GradingError), Copy(path, whole=False) as copy:
        return readings.glance(copy, task)
    return Glance()


def to_grade(exercise_id: str, path: str | None) -> tuple[str, str]:
    """What `grade` means, and what to say about it: the file that is named, or where none is this user's own."""
    if path is None:
        own, why = _choose_own(exercise.load(exercise_id), "grade")
        return str(shown(own)), f"grading {shown(own)}{why}"
    return path, ""


def shown(path: Path) -> Path:
    """A path as short as it can be said from here."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path


def _places(here: Path, task: Exercise) -> Iterator[Path]:
    yield from (here, here / task.id)
    yield from (folder / "exercises" / exercise_folders.place(task.folder) for folder in (here, *here.parents))


def _has_one(folder: Path, task: Exercise) -> bool:
    with suppress(OSError):  # a folder of somebody else's
        return (folder / task.starter).is_file() or (folder / task.notebook).is_file()
    return False
