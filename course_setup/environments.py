"""Where the environments of a course folder are, which of them is in use, and what each was made for."""

from __future__ import annotations

import fcntl
import os
import secrets
import shutil
import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_setup.problems import SetUpError, say

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

KINDS = ("wheels", "jazzy")
PATIENCE_S = 1800.0  # a slow network takes minutes for an installation


@dataclass(frozen=True)
class Environment:
    """One environment, whole or in the making. `./course` reads the files that begin with `.course-`."""

    path: Path

    @property
    def python(self) -> Path:
        """Its Python."""
        return self.path / "bin" / "python"

    def has(self, extra: str) -> bool:
        """Whether an extra of the kit is installed in it."""
        return (self.path / f".course-has-{extra}").exists()

    def finish(self, stamp: str, extra: str, made_with: str, *, unlocked: bool) -> None:
        """Note what it was made from; from now on it is whole."""
        marks = [("unlocked", "")] * unlocked + [(f"has-{extra}", "")] * bool(extra)
        for name, text in (*marks, ("python", made_with), ("stamp", stamp)):
            (self.path / f".course-{name}").write_text(f"{text}\n", "utf-8", "surrogateescape")


class Environments:
    """The environments of one course folder, of which one kind is wanted."""

    def __init__(self, root: Path, kind: str) -> None:
        self.folder = root / ".venvs"
        self.link = self.folder / kind
        self.face = root / ".venv"

    def current(self) -> Environment | None:
        """The one in use, or None."""
        return Environment(self.link.resolve()) if self.link.is_dir() else None

    def new(self) -> Environment:
        """A place for another one, which nothing leads to yet."""
        return Environment(self.folder / f"{self.link.name}-{secrets.token_hex(3)}")

    def require_face(self) -> None:
        """Look whether `.venv` is ours to change."""
        if self.face.exists() and not self.face.is_symlink():
            raise SetUpError(
                f"{self.face} was not made by ./course, which needs that name. Rename it or move it away, then run the "
                "same command again."
            )

    def put_in_force(self, environment: Environment) -> None:
        """Have the links lead to it."""
        self._lead(self.link, environment.path.name)
        self._lead(self.face, f"{self.folder.name}/{environment.path.name}")

    def remove_unused(self, uv: Path, before: Environment | None) -> None:
        """Remove what no link leads to, except the one in use before, in which programs may still run."""
        kept = {link.resolve() for link in (uv.parent, self.face, *(self.folder / kind for kind in KINDS))}
        for path in list(self.folder.iterdir()):
            if path.name.startswith("link-"):
                path.unlink()
            elif path.is_dir() and not path.is_symlink() and path not in kept and Environment(path) != before:
                shutil.rmtree(path, ignore_errors=True)

    def _lead(self, link: Path, target: str) -> None:
        fresh = self.folder / f"link-{secrets.token_hex(3)}"
        fresh.symlink_to(target)
        fresh.replace(link)


@contextmanager
def held(path: Path, patience_s: float = PATIENCE_S) -> Iterator[bool]:
    """One set-up of a folder at a time: hold the lock of this file, and tell whether another process had it before.

    It is a record lock (fcntl(2)), which works on NFS, and which the kernel takes away when its owner ends.
    """
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
    deadline = time.monotonic() + patience_s
    waited = False
    try:
        while not _take(descriptor):
            if not waited:
                say("waiting for another set-up of this folder. Ctrl-C stops waiting.")
            waited = True
            if time.monotonic() > deadline:
                raise SetUpError(
                    f"Another set-up of this folder has not finished within {patience_s / 60:.0f} minutes. Stop it, "
                    "then run the same command again."
                )
            time.sleep(0.2)  # a wait in the kernel would have no deadline
        yield waited
    finally:
        os.close(descriptor)  # and with it the lock


def _take(descriptor: int) -> bool:
    try:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):  # EAGAIN or EACCES: the system's choice
        return False
    return True
