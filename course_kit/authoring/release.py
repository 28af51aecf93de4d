"""`course-kit release`: the student edition, which is the course without its answers.

`edition_plan` decides what goes in. The edition gets its name only if `leaks` finds no answer in it.
"""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
import zipfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat

from course_kit import environment
from course_kit.authoring import edition_plan, leaks
from course_kit.grading.errors import GradingError
from course_kit.text.console import note
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from course_kit.authoring.edition_plan import EditionPlan
    from course_kit.authoring.leaks import Leak

NAME = "ros2-course"  # the folder inside a zip
ANSWERS_FOUND = 1
_LIST = "course_kit/authoring/edition.toml"
_NAMED = 10  # files that are named; of more, their folders with counts
_OTHER_ARCHIVES = (".tar", ".gz", ".tgz", ".bz2", ".xz", ".7z", ".rar")


class AnswersFoundError(GradingError):
    """There are answers in the edition; the text names them."""


def release_edition(target: str, without: Collection[str] = (), left_out_file: str | None = None) -> int:
    """Make the student edition and say what it is."""
    try:
        path, planned = make_edition(Path(target), without)
    except AnswersFoundError as problem:
        note(problem)
        return ANSWERS_FOUND
    print("\n".join([f"The student edition is in {path}.", *describe_edition(planned)]))
    if left_out_file is not None:
        listed = "".join(f"{name}\n" for name in planned.left_out)
        environment.write_atomically(Path(left_out_file), os.fsencode(listed))
    return 0


def make_edition(target: Path, without: Collection[str] = ()) -> tuple[Path, EditionPlan]:
    """Write the student edition, which appears under its name only when it is complete and holds no answers."""
    root = environment.checkout_folder()
    if root is None:
        raise GradingError("A student edition is made from the course's folder. Run ./course release there.")
    target = target.absolute()
    _require_free(target)
    planned = edition_plan.plan_edition(root, without)
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".release-", dir=target.parent) as workshop:
        built = Path(workshop) / NAME
        build_edition(planned, built)
        note("Grading the programs in the edition; this takes a minute.")
        if found := leaks.find_leaks(built, planned.solutions):
            raise AnswersFoundError(_describe_leaks(found))
        if _is_zip(target):
            packed = Path(workshop) / "student.zip"
            pack_edition(built, packed)
            packed.replace(target)
        else:
            built.replace(target)
    return target, planned


def build_edition(planned: EditionPlan, folder: Path) -> None:
    """Write the files of an edition."""
    for name, source in planned.files.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target)
        target.chmod(target.stat().st_mode | stat.S_IWUSR)  # a course that is read-only makes an edition that is not
        if name.startswith("notebooks/") and target.suffix == ".ipynb":
            _leave_answers_out(target, name)


def pack_edition(folder: Path, archive: Path) -> None:
    """Zip an edition's folder, which within the zip has the course's name; who may run a file stays with it."""
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                packed.write(path, f"{NAME}/{path.relative_to(folder).as_posix()}")


def describe_edition(planned: EditionPlan) -> Iterator[str]:
    """What to say of an edition, in lines."""
    yield (
        f"It holds {_count(len(planned.files), 'file')} and {_count(len(planned.exercises), 'exercise')}: "
        f"{', '.join(planned.exercises) or 'none'}."
    )
    if planned.drills:
        yield f"For practice it holds {_count(len(planned.drills), 'drill')}: {', '.join(planned.drills)}."
    yield "Checked: no program in it scores more than its exercise's starter, or holds more than half of a solution."
    yield f"Left out: {_name_folders(planned.instructors)}."
    if planned.unwanted:
        yield f"Left out, as you asked: {', '.join(planned.unwanted)}."
    for name, folder in planned.added.items():
        yield f"Put in from another folder: {name} ({folder})."
    if planned.untracked:
        yield f"Left out, because git does not know them: {_name(planned.untracked)}. To put them in: git add FILE"
    if planned.undecided:
        yield (
            f"Left out, because they are on no list: {_name(planned.undecided)}. "
            f"To put them in, or to say that they stay out, name them in {_LIST}."
        )
    if planned.changed:
        yield f"Differ from the last commit: {_name(planned.changed)}."


def _describe_leaks(found: Sequence[Leak]) -> str:
    lines = "\n".join(f"  {one_line(leak.file)}, for {leak.exercise}: {leak.why}" for leak in found)
    return (
        f"no student edition was made: there are answers in it.\n{lines}\n"
        f"Take them out, or name their files among the instructor's in {_LIST}; then run this again."
    )


def _is_zip(target: Path) -> bool:
    return target.suffix.lower() == ".zip"


def _require_free(target: Path) -> None:
    if _is_zip(target):
        if target.exists():
            raise GradingError(f"{target} exists already. Remove it, or choose another name.")
    elif target.suffix.lower() in _OTHER_ARCHIVES:
        raise GradingError("`release` writes a folder or a .zip file. Name a folder, or a file that ends in .zip.")
    elif target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise GradingError(f"{target} exists and is not an empty folder. Remove it, or choose another name.")


def _leave_answers_out(target: Path, name: str) -> None:
    try:
        notebook = nbformat.read(target, as_version=4)
    except (ValueError, KeyError, AttributeError) as problem:
        raise GradingError(f"{name} is not a notebook: {problem}. Repair or remove it.") from problem
    if edition_plan.has_answers(notebook):
        nbformat.write(edition_plan.remove_answers(notebook), target)


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def _name(names: Sequence[str]) -> str:
    """Files by name, or when there are many by folder."""
    return ", ".join(map(one_line, names)) if len(names) <= _NAMED else _name_folders(names)


def _name_folders(names: Iterable[str]) -> str:
    """Files counted by folder: `solutions/ (4 files), tests/ (210 files), README.md`."""
    counts = Counter(_folder_of(name) for name in names)
    lines = [
        f"{one_line(name)} ({_count(count, 'file')})" if name.endswith("/") else one_line(name)
        for name, count in sorted(counts.items())
    ]
    return ", ".join(lines) or "nothing"


def _folder_of(name: str) -> str:
    """The folder to count a file in; its own name at the top. The kit is shown one level deeper."""
    parts = name.split("/")
    depth = 2 if parts[0] == "course_kit" else 1
    return name if len(parts) <= depth else "/".join(parts[:depth]) + "/"
