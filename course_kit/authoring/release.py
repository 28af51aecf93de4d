"""`course-kit release`: the student edition, which is the course without its answers.

`edition_plan` decides what goes in, by the lists in edition.toml: of the exercises the files as they were committed, of
the demos all but the cells of the instructor. Then every program that is
found in the edition is graded (`proof`), and the edition gets its name only if none scores more than a starter does.
What is left is a course of its own: `./course lab` and `./course test` work in it.
"""

from __future__ import annotations

import os
import shutil
import stat
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat

from course_kit import environment
from course_kit.authoring import edition_notebooks, edition_plan, proof, release_text
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Collection

    from course_kit.authoring.edition_plan import EditionPlan
    from course_kit.authoring.proof import EditionProof

NAME = "ros2-course"  # the folder inside a zip
ANSWERS_FOUND, FAILED = 1, 2


class ReleaseError(RuntimeError):
    """The student edition cannot be made; the text is for the user."""


class AnswersFoundError(ReleaseError):
    """Programs in the edition score more than a starter; the text has a table of them."""


def run(target: str, without: Collection[str] = (), left_out_file: str | None = None) -> int:
    """Make the student edition and say what it is.

    Args:
        target: see `make`.
        without: see `make`.
        left_out_file: where to write the name of every file that stays out; nowhere if None.

    Returns:
        0 when it was made, 1 when programs in it score more than a starter, 2 when it or the list could not be made.
    """
    try:
        path, planned, proven = make(Path(target), without)
    except AnswersFoundError as problem:
        print(f"course-kit: {problem}", file=sys.stderr)
        return ANSWERS_FOUND
    except (ReleaseError, GradingError) as problem:
        print(f"course-kit: {problem}", file=sys.stderr)
        return FAILED
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        print(f"course-kit: the student edition could not be written: {problem.strerror}{where}.", file=sys.stderr)
        return FAILED
    print(release_text.made(path, planned, proven))
    return 0 if left_out_file is None else _list_left_out(planned, Path(left_out_file))


def make(target: Path, without: Collection[str] = ()) -> tuple[Path, EditionPlan, EditionProof]:
    """Write the student edition.

    It appears under its name only when it is complete and proven.

    Args:
        target: a folder that does not exist yet or is empty, or a file that ends in .zip.
        without: ids of exercises that shall not go in.

    Returns:
        the target, as an absolute path; what went in; and what was graded.

    Raises:
        AnswersFoundError: a program in it scores more than its exercise's starter.
        ReleaseError: there is something in the way, or this is not the course's folder.
        GradingError: a list or an exercise.toml has a mistake, or the programs in it cannot be graded here.
        OSError: it cannot be written.
    """
    root = environment.checkout()
    if root is None:
        raise ReleaseError("A student edition is made from the course's folder. Run ./course release there.")
    target = target.absolute()
    _require_free(target)
    planned = edition_plan.plan(root, without)
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".release-", dir=target.parent) as workshop:
        built = Path(workshop) / NAME
        build(planned, built)
        proven = proof.prove(built, planned.solutions, release_text.ProofProgress(sys.stderr))
        if proven.findings:
            raise AnswersFoundError(release_text.answers_found(proven))
        if _is_zip(target):
            packed = Path(workshop) / "student.zip"
            pack(built, packed)
            packed.replace(target)
        else:
            built.replace(target)
    return target, planned, proven


def build(planned: EditionPlan, folder: Path) -> None:
    """Write the files of an edition.

    Args:
        planned: what goes in.
        folder: where to.

    Raises:
        ReleaseError: a notebook cannot be read.
        OSError: it cannot be written.
    """
    for name, source in planned.files.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, target)
        target.chmod(target.stat().st_mode | stat.S_IWUSR)  # a course that is read-only makes an edition that is not
        if name.startswith("notebooks/") and target.suffix == ".ipynb":
            _leave_answers_out(target, name)


def _list_left_out(planned: EditionPlan, path: Path) -> int:
    try:
        environment.write_atomically(path, os.fsencode("".join(f"{name}\n" for name in planned.left_out)))
    except OSError as problem:
        print(
            f"course-kit: the list of what was left out could not be written: {problem.strerror} ({path}).",
            file=sys.stderr,
        )
        return FAILED
    return 0


def _is_zip(target: Path) -> bool:
    return target.suffix.lower() == ".zip"


def _require_free(target: Path) -> None:
    if _is_zip(target):
        if target.exists():
            raise ReleaseError(f"{target} exists already. Remove it, or choose another name.")
    elif target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise ReleaseError(f"{target} exists and is not an empty folder. Remove it, or choose another name.")


def _leave_answers_out(target: Path, name: str) -> None:
    try:
        notebook = nbformat.read(target, as_version=4)
    except (ValueError, KeyError, AttributeError) as problem:
        raise ReleaseError(f"{name} is not a notebook: {problem}. Mend it, or take it away.") from problem
    if edition_notebooks.has_answers(notebook):
        nbformat.write(edition_notebooks.without_answers(notebook), target)


def pack(folder: Path, archive: Path) -> None:
    """Zip an edition's folder; who may run a file stays with it.

    Args:
        folder: the folder; within the zip it has the course's name.
        archive: the new zip.

    Raises:
        OSError: it cannot be written.
    """
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                packed.write(path, f"{NAME}/{path.relative_to(folder).as_posix()}")
