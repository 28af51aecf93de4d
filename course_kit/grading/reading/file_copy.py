"""The bytes of a .py or .ipynb file, copied and counted: they are a stranger's, and `reader` has them read."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from pathlib import Path
from typing import BinaryIO

from course_kit.grading.errors import GradingError
from course_kit.grading.model.submission import UnreadableError
from course_kit.process import Closable
from course_kit.process.libc import make_memory_file
from course_kit.reader.files import ARCHIVE, YAML
from course_kit.reader.text import NOTEBOOK, PROGRAM, kind_of_file

_MB = 1 << 20
LARGEST = _MB  # bytes of a program
LARGEST_NOTEBOOK = 64 * _MB  # bytes of a notebook's file, most of them outputs
_LARGEST = {PROGRAM: LARGEST, YAML: LARGEST, NOTEBOOK: LARGEST_NOTEBOOK, ARCHIVE: LARGEST_NOTEBOOK}
_MOST_FILES = 1000  # in a folder with everything that lies below it
# Rights belong to whoever grades: a file that was closed to them, perhaps by another submission, is nobody's zero.
_OF_THE_MACHINE = (
    *(errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EIO),
    *(errno.EACCES, errno.EPERM, errno.ESTALE),
)


class Copy(Closable):
    """A copy of a submission's file in memory: its name, its size in bytes, and SHA-256 of its kind and bytes."""

    def __init__(self, name: str, *, several: bool) -> None:
        self.name, self.size, self.digest = name, 0, ""
        self._several = several
        self._file = open(make_memory_file("submission"), "wb")  # noqa: PTH123, SIM115

    def fileno(self) -> int:
        """Its descriptor."""
        return self._file.fileno()

    def close(self) -> None:
        """Let go of it."""
        self._file.close()

    def fill(self, path: Path, *, whole: bool) -> str:
        """Take in a file, or the files of a folder; returns the digest."""
        if self._several and path.is_dir():
            return self._pack(path)
        ending = kind_of_file(path.name) or (path.suffix.lower() if self._several else "")
        digest = hashlib.sha256(ending.encode() + b"\0")
        with open(_open(path), "rb", buffering=0) as source:
            if ending not in (_LARGEST if self._several else (PROGRAM, NOTEBOOK)):
                raise UnreadableError(f"{path.name} is neither a .py nor an .ipynb file. Hand in one of these.")
            most = _LARGEST[ending]
            while block := self._read(source, min(_MB, most + 1 - self.size), path):
                self.size += len(block)
                if self.size > most:
                    if whole:
                        raise UnreadableError(_too_large(path))
                    break
                digest.update(block)
                self._file.write(block)
            self._file.flush()
        return digest.hexdigest()

    def _pack(self, folder: Path) -> str:
        """The programs, parameter files and notebooks below a folder, of which `reader.files` takes those it wants."""
        import zipfile

        self.name += ARCHIVE
        digest = hashlib.sha256()
        with zipfile.ZipFile(self._file, "w") as archive:
            for path in _list_submission_files(folder):
                with open(_open(path), "rb", buffering=0) as source:
                    data = source.read(LARGEST_NOTEBOOK + 1 - self.size)
                self.size += len(data)
                if self.size > LARGEST_NOTEBOOK:
                    raise UnreadableError(
                        f"The files in {folder.name} have more than {LARGEST_NOTEBOOK // _MB} MB. Leave others out."
                    )
                name = path.relative_to(folder).as_posix().encode(errors="replace").decode()
                archive.writestr(zipfile.ZipInfo(name), data)
                digest.update(f"{name}\0{len(data)}\0".encode() + data)
        self._file.flush()
        return digest.hexdigest()

    @staticmethod
    def _read(source: BinaryIO, most: int, path: Path) -> bytes:
        try:
            return source.read(most)
        except OSError as problem:
            raise _not_read(path, problem) from None


def copy_file(path: Path, *, whole: bool = True, several: bool = False) -> Copy:
    """Copy a file; or, where an exercise asks for several, those of a folder as a zip archive."""
    try:
        copy = Copy(path.name or path.absolute().name, several=several)
        try:
            copy.digest = copy.fill(path, whole=whole)
        except BaseException:
            copy.close()
            raise
    except OSError as problem:  # what concerns the file itself is an UnreadableError
        raise GradingError(f"A submission could not be read: {problem.strerror}.") from problem
    return copy


def _list_submission_files(folder: Path) -> list[Path]:
    """The files below a folder that may be of a submission, hidden folders and what links lead to left out."""
    found: list[Path] = []
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(folder for folder in folders if not folder.startswith("."))
        found += (Path(place, name) for name in sorted(names) if Path(name).suffix in (PROGRAM, YAML, NOTEBOOK))
        if len(found) > _MOST_FILES:
            raise UnreadableError(f"{folder.name} holds more than {_MOST_FILES} files. Name the folder of your answer.")
    return found


def _open(path: Path) -> int:
    """A descriptor of an ordinary file."""
    try:
        leads_out = path.is_symlink() and path.resolve().parent != path.parent.resolve()
        descriptor = -1 if leads_out else os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY)
    except FileNotFoundError:
        raise UnreadableError(f"There is no file {path}.") from None
    except (OSError, RuntimeError, ValueError) as problem:  # a loop of links, no permission, a null byte in the name
        raise _not_read(path, problem) from None
    if leads_out:
        raise UnreadableError(f"{path.name} is a link to a file outside its folder. Hand in the file itself.")
    mode = os.fstat(descriptor).st_mode
    if stat.S_ISREG(mode):
        return descriptor
    os.close(descriptor)
    if stat.S_ISDIR(mode):
        raise UnreadableError(f"{path.name or path} is a folder. Name the .py or .ipynb file in it.")
    raise UnreadableError(f"{path.name} is not an ordinary file. Hand in a .py or .ipynb file.")


def _not_read(path: Path, problem: Exception) -> UnreadableError | GradingError:
    fault = GradingError if getattr(problem, "errno", None) in _OF_THE_MACHINE else UnreadableError
    return fault(f"{path.name} cannot be read: {getattr(problem, 'strerror', None) or problem}.")


def _too_large(path: Path) -> str:
    if kind_of_file(path.name) == PROGRAM:
        return f"{path.name} is larger than {LARGEST // 1024} kB. Hand in only the program."
    return f"{path.name} is larger than {LARGEST_NOTEBOOK // _MB} MB. Clear its outputs and save it again."
