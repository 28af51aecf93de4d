"""Where a learner's own files are: in a learner's folder, made from the course the first time they start it.

In a clone it lies inside, where git ignores it: lessons that have been run never make the clone differ from its
commit. Where the course is an installed package, or a folder that belongs to somebody else, it lies in the learner's
home directory. `watch`, `reset` and the like find the files there, or where one stands.
"""

from __future__ import annotations

import io
import os
import shlex
import shutil
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.grading.reading_answers import Glance
from course_kit.grading.readings import Readings
from course_kit.grading.submission import Copy, UnreadableError
from course_kit.learner import handed_out, learner_folder, own_versions
from course_kit.reader import fingerprints, text
from course_kit.text.console import cannot, tell

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.exercise import Exercise

_COMMAND = "course"
_MARK = "#!/bin/sh\n# The course's command, made by it.\n"
_INSTALLED_COMMAND = (
    _MARK
    + """python={python}
[ -x "$python" ] || exec course-kit "$@"
exec "$python" -c 'import sys
sys.path[:] = filter(None, sys.path)
from course_kit.cli.main import main
sys.exit(main())' "$@"
"""
)
# A student edition comes without it. Students may hand in by git, so git does not ignore their folder there.
_IN_AUTHORS_COURSE = (environment.PACKAGE / "authoring").is_dir()
_AT_ONCE_S = 60.0  # files that one download or one copy wrote are of one age
_LEFT_OUT = shutil.ignore_patterns(
    ".ipynb_checkpoints", "__pycache__", "*.backup-*", f"*.{learner_folder.BESIDE}*", "solution", exercise_folders.PROOF
)


def copy(target: Path | None, *, restore: bool = True) -> int:
    """Make a learner's folder, or bring one up to date, and say where it is; 2 where that cannot be done.

    Args:
        target: the folder, which may be there already; the one that one is in, or the usual one, when None.
        restore: bring back what the learner has deleted, too.
    """
    root = environment.course_files()
    if root is None:
        return cannot("the lessons and exercises are missing in this installation. Install the course again.")
    target = target or _my_folder()
    try:
        target = target.absolute() if target == root / environment.LEARNER_FOLDER else target.resolve()
        if target != root / environment.LEARNER_FOLDER and (target == root or root in target.parents):
            return cannot(f"{target} is inside the course's folder. Name another folder.")
        if not restore and not target.is_dir():
            return cannot(f"there is no folder {target} to update. Make one with: {environment.command()} lab {target}")
        changes = make_copy(root, target, restore=restore)
    except OSError as problem:
        return cannot(f"{problem.filename or target} could not be written: {problem.strerror or problem}.")
    if restore:
        print(f"The lessons and exercises are in {target}. What you have changed there stays as it is.")
    elif not changes:
        print(f"{target} is up to date.")
    return 0


def make_copy(root: Path, target: Path, *, restore: bool = False) -> bool:
    """Make a learner's folder, or bring one up to date; says what that means for the learner's files.

    Args:
        root: the course's folder.
        target: the learner's folder.
        restore: bring back what the learner has deleted, too.

    Returns:
        whether there was something to say.

    Raises:
        OSError: it cannot be written.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    in_clone = target.parent == root
    committed = {} if environment.checkout() is None else own_versions.committed(root, environment.paths.COPIED)
    course = {}
    for source in _files(root):
        path = source.relative_to(root).as_posix()
        course[path] = handed_out.as_handed_out(source.name, committed.get(path) or source.read_bytes())
    told = learner_folder.update(target, course, restore=restore).sentences()
    for sentence in told:
        tell(sentence)
    with suppress(OSError):  # a convenience: `course-kit` does the same
        _put_command(root, target)
    ignored = target / ".gitignore"
    if in_clone and _IN_AUTHORS_COURSE and not ignored.exists():
        environment.write_atomically(ignored, "*\n")
    return bool(told)


def _put_command(root: Path, target: Path) -> None:
    """Have `./course` work in a learner's folder as the lessons say it; a file of the learner's own stays."""
    command = target / _COMMAND
    if environment.checkout() is None:
        text = _INSTALLED_COMMAND.format(python=shlex.quote(sys.executable))
        mine = not command.exists() or (command.is_file() and command.read_bytes()[: len(_MARK)] == _MARK.encode())
        if mine and (not command.exists() or command.read_text(encoding="utf-8") != text):
            environment.write_atomically(command, text)
            command.chmod(0o755)
    elif not command.exists() or (command.is_symlink() and command.readlink() != root / _COMMAND):
        command.unlink(missing_ok=True)
        command.symlink_to(root / _COMMAND)


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


def read_starter(file: Path) -> bytes:
    """A starter of the course: as it lies there, or as it was committed where somebody has worked on it in a clone.

    Raises:
        OSError: it cannot be read.
    """
    root = environment.checkout()
    if root is not None and file.is_relative_to(root):
        path = file.relative_to(root).as_posix()
        if (kept := own_versions.committed(root, [path]).get(path)) is not None:
            return kept
    return file.read_bytes()


def exercise_folder(task: Exercise) -> Path | None:
    """The folder with this user's files of an exercise: found from where they are, else in their learner's folder.

    The course's own where there is no other yet; None where they cannot write that.
    """
    course = task.folder
    here = _working_folder()
    own = exercise_folders.course_folder()
    around = course if own is None or exercise_folders.is_added(course) else own.parent
    mine = _my_folder()
    if here is None or (here.is_relative_to(around) and not here.is_relative_to(mine)):
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
    """This user's program of an exercise, or its notebook where that is the answer: see `_choose_own`.

    Raises:
        GradingError: there is none; `verb` is what the user wanted.
    """
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
    given = set(_identities_of_starters(task))
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


def _identities_of_starters(task: Exercise) -> Iterator[str]:
    """Of the starters and of an empty program: nobody has begun with these."""
    yield ""
    for name in (task.starter, task.notebook):
        with suppress(OSError, text.UnreadableTextError):
            content = read_starter(task.folder / name)
            yield fingerprints.identity(text.program(name, io.BytesIO(content), task.id)[0])


def to_grade(exercise_id: str, path: str | None) -> tuple[str, str]:
    """What `grade` means, and what to say about it: the file that is named, or where none is this user's own.

    Raises:
        GradingError: there is no such exercise, or no file of theirs.
    """
    if path is None:
        own, why = _choose_own(exercise.load(exercise_id), "grade")
        return str(shown(own)), f"grading {shown(own)}{why}"
    course, mine = exercise_folders.course_folder(), _my_folder() / "exercises"
    here = Path(path).absolute()
    if course is None or not here.is_relative_to(course):
        return path, ""
    twin = mine / here.relative_to(course)
    said = f"{path} is the course's own file. Yours is {shown(twin)}: {environment.command()} grade {exercise_id}"
    return path, said if twin.is_file() and _as_given(here) else ""


def _as_given(file: Path) -> bool:
    """Whether a file is the starter still."""
    with suppress(OSError):
        return file.read_bytes() == read_starter(file)
    return False


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
