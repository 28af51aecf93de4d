"""Where a learner's own files are: in a learner's folder, made from the course the first time they start it.

In a clone it lies inside, where git ignores it; else in the learner's home directory. A manifest in it says what was
handed out: a new version takes the place of what the learner has not changed, and is laid beside what they have.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import FileSummary, Reader, copy_file, starter_identities
from course_kit.text.console import note, refuse

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


BESIDE = "new-version"
GUIDANCE = Path(__file__).with_name("AGENTS.md")  # for an assistant who helps the learner
_COMMAND = "course"
_FORMAT_VERSION = 1
# A student edition comes without it. Students may hand in by git, so git does not ignore their folder there.
_IN_AUTHORS_COURSE = (environment.PACKAGE / "authoring").is_dir()
_AT_ONCE_S = 60.0  # files that one download or one copy wrote are of one age
_LEFT_OUT = shutil.ignore_patterns(
    ".ipynb_checkpoints", "__pycache__", "*.backup-*", f"*.{BESIDE}*", "solution", exercise_folders.PROOF
)


def copy_course(target: Path | None) -> int:
    """Make a learner's folder, or bring one up to date, and say where it is; 2 where that cannot be done."""
    root = environment.course_files()
    if root is None:
        return refuse("the lessons and exercises are missing in this installation. Install the course again.")
    target = target or _my_folder()
    target = target.absolute() if target == root / environment.LEARNER_FOLDER else target.resolve()
    if target != root / environment.LEARNER_FOLDER and (target == root or root in target.parents):
        return refuse(f"{target} is inside the course's folder. Name another folder.")
    make_copy(root, target, restore=True)
    print(f"The lessons and exercises are in {target}. What you have changed there stays as it is.")
    return 0


def make_copy(root: Path, target: Path, *, restore: bool = False) -> None:
    """Make a learner's folder, or bring new versions into one; with `restore` also what the learner has deleted."""
    target.parent.mkdir(parents=True, exist_ok=True)
    course = {
        source.relative_to(root).as_posix(): clear_for_learner(source.name, source.read_bytes())
        for source in _files(root)
    }
    course[GUIDANCE.name] = GUIDANCE.read_bytes()
    for sentence in bring_up_to_date(target, course, restore=restore):
        note(sentence)
    with suppress(OSError):  # a convenience: `course-kit` does the same
        _put_command(target / _COMMAND, root)
    ignored = target / ".gitignore"
    if target.parent == root and _IN_AUTHORS_COURSE and not ignored.exists():
        environment.write_atomically(ignored, "*\n")


def bring_up_to_date(folder: Path, course: Mapping[str, bytes], *, restore: bool = False) -> list[str]:
    """Make a learner's folder, or bring new versions into it; returns what to tell the learner."""
    known = _read_manifest(folder)
    renewed: list[str] = []
    beside: list[str] = []
    handed_out = {path: digest_answer(path, content) for path, content in course.items()}
    for path, content in course.items():
        file, new, given = folder / path, handed_out[path], known.get(path)
        theirs = _digest_of(file)
        is_missing = theirs is None and (restore or given != new)
        if is_missing or (theirs == given and new != given):
            environment.write_atomically(file, content, durable=not is_missing)
            renewed += [path] if given not in (None, new) else []
        elif theirs not in (None, new) and new != given:
            beside.append(f"{path} as {_lay_beside(file, content)}")
    if (now := {**known, **handed_out}) != known:
        manifest = {"format_version": _FORMAT_VERSION, "handed_out": now}
        environment.write_atomically(folder / environment.paths.MANIFEST, f"{json.dumps(manifest, indent=1)}\n")
    lines = [f"New version of {', '.join(renewed)}; you had not changed the old one."] if renewed else []
    if beside:
        lines.append(
            f"You have changed files that have a new version. Yours stay; the new version of {', '.join(beside)}."
        )
    return lines


def clear_for_learner(name: str, content: bytes) -> bytes:
    """A file of the course as a learner gets it: a notebook opens without outputs, which would tell what comes."""
    notebook = _notebook(name, content)
    if notebook is None:
        return content
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            cell["outputs"], cell["execution_count"] = [], None
    notebook.setdefault("metadata", {})["language_info"] = language_info()
    return f"{json.dumps(notebook, indent=1, ensure_ascii=False)}\n".encode()


def language_info() -> dict[str, Any]:
    """What a kernel says of its language: JupyterLab writes it into each notebook, and then calls it unsaved."""
    from ipykernel.ipkernel import IPythonKernel

    return dict(IPythonKernel.language_info)


def digest_answer(name: str, content: bytes) -> str:
    """What a learner has written in a file, as a hash: of a notebook its cells, whatever their outputs are."""
    if (notebook := _notebook(name, content)) is not None:
        cells = [[cell["cell_type"], "".join(cell.get("source", ""))] for cell in notebook["cells"]]
        content = json.dumps(cells).encode()
    return hashlib.sha256(content).hexdigest()


def _digest_of(path: Path) -> str | None:
    """The hash of a file; None if it is missing, and "" if it cannot be read, as a folder."""
    try:
        return digest_answer(path.name, path.read_bytes())
    except FileNotFoundError:
        return None
    except (IsADirectoryError, PermissionError):
        return ""


def _lay_beside(file: Path, content: bytes) -> str:
    """Write a new version beside a learner's file; returns its name. Another one that they changed stays, too."""
    number, name = 1, f"{file.stem}.{BESIDE}{file.suffix}"
    while _digest_of(file.with_name(name)) not in (None, digest_answer(name, content)):
        number += 1
        name = f"{file.stem}.{BESIDE}-{number}{file.suffix}"
    environment.write_atomically(file.with_name(name), content)
    return name


def _read_manifest(folder: Path) -> dict[str, str]:
    """By path the hash of what was handed out; empty where nobody knows."""
    try:
        found = json.loads((folder / environment.paths.MANIFEST).read_bytes())["handed_out"]
        return {str(path): str(value) for path, value in found.items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


def _notebook(name: str, content: bytes) -> dict[str, Any] | None:
    """A notebook's content; None for anything else, a damaged one too."""
    if not name.endswith(".ipynb"):
        return None
    try:
        found: dict[str, Any] = json.loads(content)
        whole = all(isinstance(cell["cell_type"], str) for cell in found["cells"])
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    return found if whole and isinstance(found.get("metadata", {}), dict) else None


def _put_command(command: Path, root: Path) -> None:
    """Have `./course` work in a learner's folder as the lessons say it; a file of the learner's own stays."""
    installed = Path(sys.executable).with_name("course-kit")
    ours = installed if environment.checkout_folder() is None else root / _COMMAND
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


def exercise_folder(exercise: Exercise) -> Path | None:
    """The folder with this user's files of an exercise: found from where they are, else in their learner's folder."""
    course, here, mine = exercise.folder, Path.cwd(), _my_folder()
    own = None if exercise_folders.is_added(course) else exercise_folders.course_folder()
    below = Path("exercises", exercise_folders.path_below(course))
    # Within the course another folder may hold a file of this name that is no starter.
    is_outside = here.is_relative_to(mine) or not here.is_relative_to(own.parent if own else course)
    places = [here, here / exercise.id, *(folder / below for folder in (here, *here.parents))] if is_outside else []
    for folder in (*places, *([mine / below] if own else [])):
        with suppress(OSError):  # a folder of somebody else's
            if any((folder / name).is_file() for name in exercise.starters):
                return folder
    its_own = own is None or environment.checkout_folder() is not None  # nobody works in a package
    return course if its_own and environment.paths.is_writable(course, make=False) else None


def no_files_of(exercise: Exercise, verb: str) -> GradingError:
    """What to tell a user of whose files `exercise_folder` knows nothing; `verb` is what they wanted."""
    command = environment.course_command()
    why = f"There is no {exercise.starter} of yours here"
    if environment.checkout_folder() is not None:
        why = f"The course's folder is read-only for you, and there is no {exercise.starter} of yours here"
    return GradingError(
        f"{why}. Make your own copy of the course with {command} copy, or name your file: "
        f"{command} {verb} {exercise.id} FILE."
    )


def choose_own(exercise: Exercise, verb: str) -> tuple[Path, str]:
    """Of program and notebook the one that a class run would grade, and why where both are there."""
    folder = exercise_folder(exercise)
    if folder is None:
        raise no_files_of(exercise, verb)
    program, notebook = folder / exercise.starter, folder / exercise.notebook
    if not (program.is_file() and notebook.is_file()):
        only = folder if exercise.files else program
        return (notebook if notebook.is_file() else only), ""
    answers = (folder if exercise.files else program, notebook)
    with Reader() as readings:
        seen = {path: _glance(readings, path, exercise) for path in answers}
    given = starter_identities(exercise) | {""}  # nobody has begun with these, nor with an empty program
    changed = [path for path, glance in seen.items() if glance.identity not in given]
    fitting = [path for path in changed if seen[path].found]
    if len(changed) == 1 or len(fitting) == 1:
        best = (fitting or changed)[0]
        other = next(path for path in answers if path != best)
        lacks = "is still the starter" if len(changed) == 1 else f"does not contain {exercise.asks_for}"
        return best, f", because {other.name} {lacks}"
    if not changed:
        return answers[0], ""
    files = [folder / name for name in exercise.files] or [program]  # a folder is as new as what was last put in
    is_newer = notebook.stat().st_mtime > max(one.stat().st_mtime for one in files if one.exists()) + _AT_ONCE_S
    other, best = answers if is_newer else answers[::-1]
    named = f"{environment.course_command()} {verb} {exercise.id} {shorten_path(other)}"
    return best, f", the newer of your two answers. For the other one: {named}"


def _glance(readings: Reader, path: Path, exercise: Exercise) -> FileSummary:
    """What a file looks like; one that cannot be read is graded if it is all there is, and the report says why."""
    with suppress(UnreadableError, GradingError), copy_file(path, whole=False, several=bool(exercise.files)) as copy:
        return readings.summarize(copy, exercise)
    return FileSummary()


def choose_to_grade(exercise_id: str, path: str | None) -> tuple[str, str]:
    """What `grade` means, and what to say about it: the file that is named, or where none is this user's own."""
    if path is None:
        own, why = choose_own(load_exercise(exercise_id), "grade")
        return str(shorten_path(own)), f"grading {shorten_path(own)}{why}"
    course, given = exercise_folders.course_folder(), Path(path).absolute()
    if course is not None and given.is_relative_to(course):
        yours = _my_folder() / "exercises" / given.relative_to(course)
        if yours.is_file():
            command = f"{environment.course_command()} grade {exercise_id}"
            return path, f"{path} is the course's own file. Yours is {shorten_path(yours)}: {command}"
    return path, ""


def shorten_path(path: Path) -> Path:
    """A path as short as it can be said from here."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path
