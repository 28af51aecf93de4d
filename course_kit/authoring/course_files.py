"""Which files belong to the course, by git where this is a clone; and which git does not know or sees changed."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator

_GENERATED = {
    ".git", ".venv", ".venvs", ".course", ".hypothesis", ".mypy_cache", ".pytest_cache", ".ruff_cache",
    ".ipynb_checkpoints", "__pycache__", "artifacts", "build", "dist", "PKG-INFO",
    environment.LEARNER_FOLDER,
}  # fmt: skip
_GENERATED_ENDINGS = (".so", ".pyc", ".tmp", ".zip")


@dataclass(frozen=True)
class CourseFiles:
    """The files of a course's folder, as paths relative to it."""

    known: frozenset[str]  # those that git knows and that are there; without git all that nobody generated
    new: frozenset[str] = frozenset()  # those that git has not been told of, and would not ignore
    changed: frozenset[str] = frozenset()  # those that differ from the last commit, also those that are gone
    git: str = ""  # why git could not be asked; empty where it answered


def look(root: Path) -> CourseFiles:
    """The files of the course in `root`."""
    if not (root / ".git").exists():
        return CourseFiles(frozenset(_walk(root)), git="this folder is no clone")
    if shutil.which("git") is None:
        return CourseFiles(frozenset(_walk(root)), git="git is not installed")
    try:
        known = frozenset(_git(root, "ls-files", "-z"))
        new = frozenset(_git(root, "ls-files", "-z", "--others", "--exclude-standard"))
        # A repository without a commit has nothing to compare with.
        changed = frozenset(_git(root, "diff", "--name-only", "-z", "HEAD")) if _has_commit(root) else frozenset()
    except subprocess.CalledProcessError as problem:
        return CourseFiles(frozenset(_walk(root)), git=_first_line(problem.stderr))
    there = frozenset(name for name in known if (root / name).is_file())
    return CourseFiles(there, frozenset(name for name in new if not _is_made(root, name)), changed)


def _git(root: Path, *arguments: str) -> list[str]:
    """The names that git lists."""
    listed = subprocess.run(["git", *arguments], cwd=root, capture_output=True, check=True)
    return [name for name in os.fsdecode(listed.stdout).split("\0") if name]


def _has_commit(root: Path) -> bool:
    asked = subprocess.run(["git", "rev-parse", "--verify", "-q", "HEAD"], cwd=root, capture_output=True, check=False)
    return asked.returncode == 0


def _first_line(said: bytes) -> str:
    lines = said.decode(errors="replace").strip().splitlines()
    return lines[0].removeprefix("fatal: ") if lines else "git failed"


def _walk(root: Path) -> Iterator[str]:
    for folder, folders, files in os.walk(root):
        inner = Path(folder)
        folders[:] = [name for name in folders if name not in _GENERATED and not _is_a_course(inner / name)]
        for name in files:
            if name not in _GENERATED and not name.endswith(_GENERATED_ENDINGS):  # .venv is a link
                yield (inner / name).relative_to(root).as_posix()


def _is_made(root: Path, name: str) -> bool:
    """Whether a file that git does not know was made by the course's commands, such as an edition."""
    path = Path(name)
    return name.endswith(_GENERATED_ENDINGS) or any(
        _is_a_course(root / folder) for folder in path.parents if folder != Path()
    )


def _is_a_course(folder: Path) -> bool:
    """Whether a folder is a course of its own, such as an edition that was made before."""
    return (folder / "course_kit").is_dir()
