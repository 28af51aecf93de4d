"""Which processes live in an environment: as the kernel shows them, or on macOS `ps`."""

from __future__ import annotations

import os
import subprocess
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_PROCESSES = Path("/proc")


@dataclass(frozen=True)
class _Process:
    arguments: list[bytes]
    folder: Path | None = None  # its entry in /proc

    def paths(self) -> Iterator[bytes]:
        """The program and the script it was started with, as absolute paths."""
        here = b"/"
        if self.folder is not None:
            with suppress(OSError):
                here = os.fsencode((self.folder / "cwd").readlink())
        for argument in self.arguments[:2]:
            if b"/" in argument:
                yield os.path.normpath(os.path.join(here, argument))  # noqa: PTH118 - bytes

    def has_open(self, start: bytes) -> bool:
        """Whether it has libraries from there in memory, or has it as its activated environment."""
        if self.folder is None:
            return False
        with suppress(OSError):  # of somebody else, or it has just ended
            variables = (self.folder / "environ").read_bytes().split(b"\0")
            if b"VIRTUAL_ENV=" + start.rstrip(b"/") in variables:
                return True
            return start in (self.folder / "maps").read_bytes()
        return False


def is_used(environment: Path) -> bool:
    """Whether a process that can be seen from here runs in an environment."""
    start = os.fsencode(environment) + b"/"
    return any(_began_in(one, start) or one.has_open(start) for one in _processes())


def is_way_of_a_process(link: Path) -> bool:
    """Whether a process was started by a path that leads through this link, and will look for its modules there."""
    start = os.fsencode(link) + b"/"
    return any(_began_in(one, start) for one in _processes())


def _began_in(process: _Process, start: bytes) -> bool:
    return any(path.startswith(start) for path in process.paths())


def _processes() -> Iterator[_Process]:
    if not (_PROCESSES / "self" / "cmdline").exists():
        listed = subprocess.run(["ps", "-A", "-o", "args="], capture_output=True, check=False).stdout
        yield from (_Process(line.split()) for line in listed.splitlines())
        return
    for folder in _PROCESSES.iterdir():
        if folder.name.isdecimal():
            with suppress(OSError):
                yield _Process((folder / "cmdline").read_bytes().split(b"\0"), folder)
