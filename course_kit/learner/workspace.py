"""Where a learner's own files are: in the course's folder, or in a copy where that folder cannot be written.

A course may be installed once for many, and belong to somebody else. JupyterLab then opens a copy of the lessons and
exercises in the learner's home directory, and `watch` and `reset` find the files there, or where one stands.
"""

from __future__ import annotations

import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.exercise import Exercise

STARTERS = environment.PACKAGE / "starters"
PRISTINE = ".pristine"
COPIED = ("notebooks", "exercises")
_NAME = "ros2-course"
_COMMAND = "course"
_LEFT_OUT = shutil.ignore_patterns(
    ".ipynb_checkpoints", "__pycache__", "*.backup-*", "solution", exercise_folders.PROOF
)


def copy_folder() -> Path:
    """The folder of a learner's copy; it may not be there yet."""
    home = environment.home()
    return environment.state_dir() / _NAME if home is None else home / _NAME


def is_shared(root: Path) -> bool:
    """Whether this user cannot work in a course's folder."""
    return not all(environment.is_writable(root / name, make=False) for name in COPIED if (root / name).is_dir())


def copy(target: Path | None) -> int:
    """Make a user's own copy of the lessons and exercises and say where it is; 2 where that cannot be done.

    Args:
        target: the folder, which may be there already; `copy_folder` when None.
    """
    root = environment.checkout()
    if root is None:
        return cannot("the lessons and exercises are missing; there is only the package.")
    target = (copy_folder() if target is None else target).absolute()
    if target == root or root in target.parents:
        return cannot(f"{target} is inside the course's folder. Name another folder.")
    try:
        make_copy(root, target)
    except OSError as problem:
        return cannot(f"{problem.filename or target} could not be written: {problem.strerror or problem}.")
    print(f"The lessons and exercises are in {target}. Files that already existed there are unchanged.")
    return 0


def make_copy(root: Path, target: Path) -> None:
    """Put into a learner's folder what is not there yet of a course; what is there stays as it is.

    Args:
        root: the course's folder.
        target: the learner's folder.

    Raises:
        OSError: it cannot be written.
    """
    target.mkdir(parents=True, exist_ok=True)
    for source in _files(root):
        copied = target / source.relative_to(root)
        if not os.path.lexists(copied):
            environment.write_atomically(copied, _pristine(source).read_bytes(), durable=False)
    command = target / _COMMAND
    if command.is_symlink() or not command.exists():  # so that `./course` works there as the lessons say it
        command.unlink(missing_ok=True)
        command.symlink_to(root / _COMMAND)


def _files(root: Path) -> Iterator[Path]:
    for name in COPIED:
        for folder, folders, files in os.walk(root / name):
            left_out = _LEFT_OUT(folder, [*folders, *files])
            folders[:] = [each for each in folders if each not in left_out]
            yield from (Path(folder, each) for each in files if each not in left_out)


def _pristine(source: Path) -> Path:
    """The starter itself, where the course's owner may have worked on theirs."""
    kept = STARTERS / source.parent.name / f"{source.name}{PRISTINE}"
    return kept if kept.is_file() else source


def exercise_folder(task: Exercise) -> Path | None:
    """The folder with this user's files of an exercise: found from where they are, else the course's or their copy's.

    None where there is only a course's folder that they cannot write.
    """
    course = task.folder
    here = _working_folder()
    own = exercise_folders.course_folder()
    around = course if own is None or exercise_folders.is_added(course) else own.parent
    if here is None or here.is_relative_to(around):
        found = None  # within the course: another folder there may hold a file of this name that is no starter
    else:
        found = next((folder for folder in _places(here, task) if _has_one(folder, task)), None)
    if found is not None:
        return found
    if environment.is_writable(course, make=False):
        return course
    copied = copy_folder() / "exercises" / exercise_folders.place(course)
    return copied if _has_one(copied, task) else None


def no_files_of(task: Exercise, verb: str) -> GradingError:
    """What to tell a user of whose files `exercise_folder` knows nothing; `verb` is what they wanted."""
    command = environment.command()
    return GradingError(
        f"The course's folder is read-only for you, and there is no {task.starter} of yours here. Make your own copy "
        f"of the course with {command} copy, or name your file: {command} {verb} {task.id} FILE."
    )


def own_file(task: Exercise, verb: str) -> Path:
    """This user's program of an exercise, or its notebook where only that is there.

    Raises:
        GradingError: there is none; `verb` is what the user wanted.
    """
    folder = exercise_folder(task)
    if folder is None:
        raise no_files_of(task, verb)
    program, notebook = folder / task.starter, folder / task.notebook
    return notebook if notebook.is_file() and not program.is_file() else program


def shown(path: Path) -> Path:
    """A path as short as it can be said from here."""
    here = _working_folder()
    return path.relative_to(here) if here is not None and path.is_relative_to(here) else path


def _places(here: Path, task: Exercise) -> Iterator[Path]:
    yield from (here, here / task.id)
    yield from (folder / "exercises" / exercise_folders.place(task.folder) for folder in (here, *here.parents))


def _has_one(folder: Path, task: Exercise) -> bool:
    with suppress(OSError):  # a folder of somebody else's
        return (folder / task.starter).is_file() or (folder / task.notebook).is_file()
    return False


def _working_folder() -> Path | None:
    try:
        return Path.cwd()
    except OSError:  # it was removed
        return None
