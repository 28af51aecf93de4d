"""Writing files so that neither a crash nor a full disk nor a second writer leaves half of one."""

from __future__ import annotations

import os
import secrets
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_LONGEST = 40  # characters of a name within that of its temporary file: a name has at most 255 bytes


def write_atomically(
    path: Path, content: str | bytes, *, durable: bool = True, folders: bool = True, mode: int = 0o666
) -> None:
    """Write a file; who reads it meanwhile, or after a crash, finds all of it or what was there before."""
    data = content.encode() if isinstance(content, str) else content
    if folders:
        with suppress(FileExistsError):  # also a file in its place, of which opening tells more exactly
            path.parent.mkdir(parents=True)
    temporary = path.with_name(f".{path.name[:_LONGEST]}-{secrets.token_hex(8)}.tmp")
    try:
        with _create_file(temporary, mode) as descriptor:
            with suppress(FileNotFoundError):
                os.fchmod(descriptor, path.stat().st_mode & 0o777)
            _fill(descriptor, data, durable=durable)
            temporary.replace(path)
    except OSError as problem:  # whose file name may be one that nobody knows
        raise OSError(problem.errno, problem.strerror or str(problem), str(path)) from problem


def write_new(path: Path, content: bytes) -> None:
    """Write a file that is not there yet, down to the disk."""
    with _create_file(path, 0o666) as descriptor:
        _fill(descriptor, content, durable=True)


@contextmanager
def _create_file(path: Path, mode: int) -> Iterator[int]:
    """A new, empty file, open for writing; removed if anything goes wrong with it."""
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, mode)
    try:
        yield descriptor
    except BaseException:
        with suppress(OSError):
            path.unlink()
        raise
    finally:
        os.close(descriptor)


def _fill(descriptor: int, data: bytes, *, durable: bool) -> None:
    with os.fdopen(descriptor, "wb", closefd=False) as file:
        file.write(data)
    if durable:
        os.fsync(descriptor)
