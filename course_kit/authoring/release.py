"""`course-kit release`: the student edition, which is the course without its answers.

Left out are the solutions, the submissions that the graders are tested with, and the cells of the demos that are
tagged `answer`. What is left is a course of its own: `./course lab` and `./course test` work in it.
"""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator

NAME = "ros2-course"  # the folder inside a zip
ANSWER = "answer"  # a cell with this tag belongs to the instructor
# Folders with answers, or with programs that come close to one.
LEFT_OUT = (
    "solutions",
    "tests/broken",
    "tests/slips",
    "tests/grading",
    "tests/proof",
    "tests/dev",
    "tests/graders",
    ".ci",
    ".github",
)
_GENERATED = {
    ".git", ".venv", ".venvs", ".course", ".hypothesis", ".mypy_cache", ".pytest_cache", ".ruff_cache",
    ".ipynb_checkpoints", "__pycache__", "artifacts", "build", "dist",
}  # fmt: skip
_GENERATED_ENDINGS = (".so", ".pyc", ".tmp", ".zip")


class ReleaseError(RuntimeError):
    """The student edition cannot be made; the text is for the user."""


def run(target: str) -> int:
    """Make the student edition and say where it is; 2 if that could not be done."""
    try:
        path = make(Path(target))
    except ReleaseError as problem:
        print(f"course-kit: {problem}", file=sys.stderr)
        return 2
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        print(f"course-kit: the student edition could not be written: {problem.strerror}{where}.", file=sys.stderr)
        return 2
    print(f"The student edition is in {path}. It has no solutions; ./course lab and ./course test work in it.")
    return 0


def make(target: Path) -> Path:
    """Write the student edition.

    It appears under its name only when it is complete.

    Args:
        target: a folder that does not exist yet or is empty, or a file that ends in .zip.

    Returns:
        the target, as an absolute path.

    Raises:
        ReleaseError: there is something in the way, or this is not the course's folder.
        OSError: it cannot be written.
    """
    root = environment.checkout()
    if root is None:
        raise ReleaseError("A student edition is made from the course's folder. Run ./course release there.")
    target = target.absolute()
    _require_free(target)
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".release-", dir=target.parent) as workshop:
        built = Path(workshop) / NAME
        for name in contents(root):
            _put(root / name, built / name)
        if _is_zip(target):
            packed = Path(workshop) / "student.zip"
            _pack(built, packed)
            packed.replace(target)
        else:
            built.replace(target)
    return target


def contents(root: Path) -> list[str]:
    """The files of the student edition, as paths relative to the course's folder, sorted."""
    return sorted(name for name in own_files(root) if not _is_left_out(name))


def without_answers(notebook: Any) -> Any:
    """A notebook without the cells tagged `answer`; the others are numbered anew."""
    notebook.cells = [cell for cell in notebook.cells if ANSWER not in cell.metadata.get("tags", [])]
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


def _is_zip(target: Path) -> bool:
    return target.suffix.lower() == ".zip"


def _require_free(target: Path) -> None:
    if _is_zip(target):
        if target.exists():
            raise ReleaseError(f"{target} exists already. Remove it, or choose another name.")
    elif target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise ReleaseError(f"{target} exists and is not an empty folder. Remove it, or choose another name.")


def own_files(root: Path, *, new: bool = False) -> Iterator[str]:
    """What belongs to the course: what git knows, where this is a git repository; else all that nobody generated.

    Args:
        root: the course's folder.
        new: also what git has not been told of yet, and would not ignore.
    """
    also = ["--cached", "--others", "--exclude-standard"] if new else []
    listed = (
        subprocess.run(["git", "ls-files", "-z", *also], cwd=root, capture_output=True, check=False)
        if _has_git(root)
        else None
    )
    if listed is not None and listed.returncode == 0:
        names = os.fsdecode(listed.stdout).split("\0")
        yield from (name for name in names if name and (root / name).is_file())
        return
    for folder, folders, files in os.walk(root):
        inner = Path(folder)
        folders[:] = [name for name in folders if name not in _GENERATED and not _is_a_course(inner / name)]
        for name in files:
            if name not in _GENERATED and not name.endswith(_GENERATED_ENDINGS):  # .venv is a link
                yield (inner / name).relative_to(root).as_posix()


def _is_a_course(folder: Path) -> bool:
    """Whether a folder is a course of its own, such as an edition that was made before."""
    return (folder / "course_kit").is_dir()


def _has_git(root: Path) -> bool:
    return (root / ".git").exists() and shutil.which("git") is not None


def _is_left_out(name: str) -> bool:
    return any(name == folder or name.startswith(f"{folder}/") for folder in LEFT_OUT)


def _put(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(source, target)
    target.chmod(target.stat().st_mode | stat.S_IWUSR)  # a course that is read-only makes an edition that is not
    if source.suffix == ".ipynb" and "demos" in source.parts:
        nbformat.write(without_answers(nbformat.read(source, as_version=4)), target)


def _pack(folder: Path, archive: Path) -> None:
    """Zip a folder; who may run a file stays with it."""
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                packed.write(path, f"{NAME}/{path.relative_to(folder).as_posix()}")
