"""Where the environments of a course folder are, which of them is in force, and what each was made for."""

from __future__ import annotations

import os
import secrets
import shutil
import subprocess
from typing import TYPE_CHECKING

from course_setup import running
from course_setup.portable import replace
from course_setup.problems import SetUpError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

KINDS = ("wheels", "jazzy")
_REMOVED, _LINK = "removed", "link"  # how names begin that last for a moment
_STAMP = ".course-stamp"  # what it was made from; ./course compares it on each use
_PYTHON = ".course-python"  # the COURSE_PYTHON it was made with; ./course compares that, too
_UNLOCKED = ".course-unlocked"  # it was resolved afresh instead of installed from the lock; ./course looks for it, too
_OLD_MARKS = (_STAMP, ".course-unfinished")  # of the time when .venv was a folder


class Environment:
    """One environment, whole or in the making."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.python = path / "bin" / "python"

    @property
    def stamp(self) -> str:
        """The fingerprint of what it was made from; empty until it is whole."""
        return _read(self.path / _STAMP)

    @property
    def root(self) -> str:
        """The course's folder as it was called when the environment was made or last adapted."""
        return self.stamp.rpartition("\n")[2]

    @property
    def made_with(self) -> str:
        """The COURSE_PYTHON it was made with, or ""."""
        return _read(self.path / _PYTHON)

    @property
    def unlocked(self) -> bool:
        """Whether it was resolved afresh instead of installed from the lock."""
        return (self.path / _UNLOCKED).exists()

    def has(self, extra: str) -> bool:
        """Whether an extra of the kit is installed in it; "" always is."""
        return not extra or (self.path / f".course-has-{extra}").exists()

    def works(self) -> bool:
        """Whether its Python starts: the one it was made from may have been removed."""
        return self.identity() != ""

    def identity(self) -> str:
        """Version and home of its Python, or "" if it does not start."""
        return identity(str(self.python))

    def finish(self, stamp: str, extra: str, made_with: str, *, unlocked: bool = False) -> None:
        """Note that it is whole, and what it was made from."""
        if unlocked:
            (self.path / _UNLOCKED).touch()
        if extra:
            (self.path / f".course-has-{extra}").touch()
        for name, text in ((_PYTHON, made_with), (_STAMP, stamp)):
            replace(self.path / name, f"{text}\n".encode("utf-8", "surrogateescape"))


class Environments:
    """The environments of one course folder, of which one kind is wanted."""

    def __init__(self, root: Path, kind: str) -> None:
        self.root = root
        self.folder = root / ".venvs"
        self.lock = self.folder / "lock"
        self.link = self.folder / kind
        self.face = root / ".venv"

    def current(self) -> Environment | None:
        """The one in force, or None where there is none yet."""
        return Environment(self.link.resolve()) if self.link.is_dir() else None

    def new(self) -> Environment:
        """A place for another one, which nothing leads to yet."""
        return Environment(self.folder / f"{self.link.name}-{secrets.token_hex(3)}")

    def put_in_force(self, environment: Environment) -> None:
        """Have the links lead to it."""
        self._lead(self.link, environment.path.name)
        self.show(environment)

    def show(self, environment: Environment) -> None:
        """Have `.venv` lead to it, unless something was started through `.venv` that would lose its modules."""
        if not self.face.exists() or not running.is_way_of_a_process(self.face):
            self._lead(self.face, f"{self.folder.name}/{environment.path.name}")

    def is_in_force(self, environment: Environment) -> bool:
        """Whether ./course would use it."""
        return self.link.is_dir() and self.link.resolve() == environment.path

    def take_over_old_layout(self) -> None:
        """Move away a `.venv` of the time when it was a folder.

        Raises:
            SetUpError: it was not made by the course, or something runs in it.
        """
        if self.face.is_symlink() or not self.face.exists():
            return
        if not any((self.face / name).exists() for name in _OLD_MARKS):
            raise SetUpError(
                f"{self.face} was not made by ./course, which needs that name. Rename it or move it away, then run the "
                "same command again."
            )
        if running.is_used(self.face):
            raise SetUpError(
                f"Something still runs in {self.face}, an environment of an older version of the course. Close "
                "JupyterLab and the terminals that use it, then run the same command again."
            )
        self.face.rename(self.folder / f"{_REMOVED}-{secrets.token_hex(3)}")

    def remove_unused(self) -> None:
        """Remove those that no link leads to and nothing runs in. Only for the holder of the lock."""
        for left in self.folder.glob(f"{_LINK}-*"):
            left.unlink()
        in_force = {link.resolve() for link in (self.face, *(self.folder / kind for kind in KINDS))}
        for path in list(self._all()):
            if path.resolve() not in in_force and not running.is_used(path):
                self._remove(path)

    def _lead(self, link: Path, target: str) -> None:
        fresh = self.folder / f"{_LINK}-{secrets.token_hex(3)}"
        fresh.symlink_to(target)
        fresh.replace(link)

    def _all(self) -> Iterator[Path]:
        for path in self.folder.iterdir():
            if path.name.partition("-")[0] in (*KINDS, _REMOVED) and path.is_dir() and not path.is_symlink():
                yield path

    def _remove(self, path: Path) -> None:
        """Remove one; who has begun to use it meanwhile gets it back."""
        away = self.folder / f"{_REMOVED}-{secrets.token_hex(3)}"
        path.rename(away)
        if running.is_used(path) or running.is_used(away):
            away.rename(path)
        else:
            shutil.rmtree(away, ignore_errors=True)


def identity(python: str) -> str:
    """Version and home of a Python, or "" if it does not start."""
    question = "import sys; print(sys.version, sys.base_prefix)"
    try:
        asked = subprocess.run([python, "-I", "-S", "-c", question], capture_output=True, timeout=60, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return os.fsdecode(asked.stdout) if asked.returncode == 0 else ""


def _read(path: Path) -> str:
    try:
        return path.read_text("utf-8", "surrogateescape").rstrip("\n")
    except OSError:
        return ""
