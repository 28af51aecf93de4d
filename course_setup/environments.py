"""Where the environments of a course folder are, which of them is in force, and what each was made for."""

from __future__ import annotations

import os
import secrets
import shutil
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from course_setup.problems import SetUpError

KINDS = ("wheels", "jazzy")
_PROCESSES = Path("/proc")


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
        if unlocked:
            (self.path / ".course-unlocked").touch()
        if extra:
            (self.path / f".course-has-{extra}").touch()
        for name, text in (("python", made_with), ("stamp", stamp)):
            (self.path / f".course-{name}").write_text(f"{text}\n", "utf-8", "surrogateescape")


class Environments:
    """The environments of one course folder, of which one kind is wanted."""

    def __init__(self, root: Path, kind: str) -> None:
        self.folder = root / ".venvs"
        self.link = self.folder / kind
        self.face = root / ".venv"

    def current(self) -> Environment | None:
        """The one in force, or None where there is none yet."""
        return Environment(self.link.resolve()) if self.link.is_dir() else None

    def new(self) -> Environment:
        """A place for another one, which nothing leads to yet."""
        return Environment(self.folder / f"{self.link.name}-{secrets.token_hex(3)}")

    def require_face(self) -> None:
        """Look whether `.venv` is ours to change.

        Raises:
            SetUpError: it was not made by the course.
        """
        if self.face.exists() and not self.face.is_symlink():
            raise SetUpError(
                f"{self.face} was not made by ./course, which needs that name. Rename it or move it away, then run the "
                "same command again."
            )

    def put_in_force(self, environment: Environment) -> None:
        """Have the links lead to it."""
        self._lead(self.link, environment.path.name)
        self.show(environment)

    def show(self, environment: Environment) -> None:
        """Have `.venv` lead to it, unless something was started through `.venv` that would lose its modules."""
        if not self.face.exists() or not is_used(self.face):
            self._lead(self.face, f"{self.folder.name}/{environment.path.name}")

    def remove_unused(self, uv: Path) -> None:
        """Remove what no link leads to and nothing runs in, and other versions of uv. Only for the lock's holder."""
        kept = {link.resolve() for link in (uv.parent, self.face, *(self.folder / kind for kind in KINDS))}
        for path in list(self.folder.iterdir()):
            if path.name.startswith("link-"):
                path.unlink()
            elif path.is_dir() and not path.is_symlink() and path not in kept and not is_used(path):
                shutil.rmtree(path, ignore_errors=True)

    def _lead(self, link: Path, target: str) -> None:
        fresh = self.folder / f"link-{secrets.token_hex(3)}"
        fresh.symlink_to(target)
        fresh.replace(link)


def is_used(path: Path) -> bool:
    """Whether a process was started from a folder, has libraries from there in memory, or has it activated."""
    return any(_uses(process, os.fsencode(path)) for process in _PROCESSES.iterdir() if process.name.isdecimal())


def _uses(process: Path, path: bytes) -> bool:
    with suppress(OSError):  # of somebody else, or it has just ended
        program_and_script = (process / "cmdline").read_bytes().split(b"\0")[:2]
        here = os.fsencode((process / "cwd").readlink())
        started = [os.path.normpath(os.path.join(here, one)) for one in program_and_script if b"/" in one]  # noqa: PTH118
        if any(one.startswith(path + b"/") for one in started):
            return True
        if b"VIRTUAL_ENV=" + path in (process / "environ").read_bytes().split(b"\0"):
            return True
        return path + b"/" in (process / "maps").read_bytes()
    return False
