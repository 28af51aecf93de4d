"""A submission: the bytes of a .py or .ipynb file, and the program that was read out of them.

The bytes are a stranger's. Here they are only copied and counted; `course_kit.grading.reading.reader` has them read.
"""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.process import Closable
from course_kit.process.libc import make_memory_file
from course_kit.reader.text import NOTEBOOK, PROGRAM, kind_of_file

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.model.plain_data import Record


_MB = 1 << 20
LARGEST = _MB  # bytes of a program
LARGEST_NOTEBOOK = 64 * _MB  # bytes of a notebook's file, most of them outputs
_LARGEST = {PROGRAM: LARGEST, NOTEBOOK: LARGEST_NOTEBOOK}
_BLOCK = _MB
# Rights belong to whoever grades: a file that was closed to them, perhaps by another submission, is nobody's zero.
_OF_THE_MACHINE = (
    *(errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EIO),
    *(errno.EACCES, errno.EPERM, errno.ESTALE),
)


class UnreadableError(ValueError):
    """A submission that cannot be read; the text says why and what to do."""


@dataclass(frozen=True)
class SyntaxFault:
    """Where Python stopped reading: the line's number, 0 for nowhere, its text, and what Python says about it."""

    line: int
    text: str
    problem: str


@dataclass(frozen=True)
class Facts:
    """What a program's text gives away; for a diagnosis, never for a point.

    Attributes:
        awaits: `await` stands in it.
        floor_divides: `//` stands in it.
        loops: `while` stands in it.
        waits: a call that may wait for long stands in it.
        functions: first and last line of each function, and whether it makes an asynchronous call and looks at the
            future itself; none when none does.
        future: the first line in which the program makes a Future itself; 0 when there is none.
    """

    awaits: bool = False
    floor_divides: bool = False
    loops: bool = False
    waits: bool = False
    functions: tuple[tuple[int, int, bool], ...] = ()
    future: int = 0

    def waits_for_a_future(self, line: int) -> bool:
        """Whether the function around `line` makes an asynchronous call and looks at its future itself."""
        around = [one for one in self.functions if one[0] <= line <= one[1]]
        return max(around)[2] if around else False


@dataclass(frozen=True)
class Submission:
    """The program to run.

    Attributes:
        name: the file's name, for reports.
        program: the name it runs under, ends in .py.
        source: Python text with plain line ends.
        places: for each cell of a notebook that the source was joined from the cell's number, from 1, and how many
            lines it gave; empty for a .py file.
        fault: where the source is not Python; None when it is.
        facts: what its text gives away.
        literal: what it sets the exercise's variable to, where its text tells that, in the words of
            `course_kit.reader.python`; None where only running it can tell.
        twice: a class that several cells define; empty where none does.
    """

    name: str
    program: str
    source: str
    places: tuple[tuple[int, int], ...] = ()
    fault: SyntaxFault | None = None
    facts: Facts = Facts()
    literal: Record | None = None
    twice: str = ""

    @property
    def note(self) -> str:
        """What to say of a notebook with several answers."""
        return f"several cells define {self.twice}: the last one counts" if self.twice else ""

    def where(self, line: int) -> str:
        """`line 12`, for notebooks `cell 3, line 2`."""
        return where(self.places, line)


def where(places: tuple[tuple[int, int], ...], line: int) -> str:
    """Where a line of a program stands, `line 12` or `cell 3, line 2`; see `Submission.places`."""
    before = 0
    for cell, lines in places:
        if before < line <= before + lines:
            return f"cell {cell}, line {line - before + 1}"  # its first line, %%submission, is not in the program
        before += lines
    return f"line {line}"


class Copy(Closable):
    """A copy of a submission's file in memory, closed at the end of a `with`.

    Attributes:
        name: the file's name.
        size: in bytes.
        digest: SHA-256 of its kind and its bytes.
    """

    def __init__(self, path: Path, *, whole: bool = True) -> None:
        """Copy a file."""
        self.name, self.size = path.name, 0
        try:
            self._file = open(make_memory_file("submission"), "wb")  # noqa: PTH123, SIM115
            try:
                self.digest = self._fill(path, whole=whole)
            except BaseException:
                self.close()
                raise
        except OSError as problem:  # what concerns the file itself is an UnreadableError
            raise GradingError(f"A submission could not be read: {problem.strerror}.") from problem

    def fileno(self) -> int:
        """Its descriptor."""
        return self._file.fileno()

    def close(self) -> None:
        """Let go of it."""
        self._file.close()

    def _fill(self, path: Path, *, whole: bool) -> str:
        ending = kind_of_file(path.name)
        digest = hashlib.sha256(ending.encode() + b"\0")
        source = _open(path)
        try:
            if not ending:
                raise UnreadableError(f"{path.name} is neither a .py nor an .ipynb file. Hand in one of these.")
            most = _LARGEST[ending]
            while block := _read(source, min(_BLOCK, most + 1 - self.size), path):
                self.size += len(block)
                if self.size > most:
                    if whole:
                        raise UnreadableError(_too_large(path))
                    break
                digest.update(block)
                self._file.write(block)
            self._file.flush()
        finally:
            os.close(source)
        return digest.hexdigest()


def _open(path: Path) -> int:
    """A descriptor of an ordinary file."""
    try:
        _require_no_way_out(path)
        _require_a_file(path, path.stat().st_mode)
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY)
    except UnreadableError:
        raise
    except FileNotFoundError:
        raise UnreadableError(f"There is no file {path}.") from None
    except (OSError, RuntimeError, ValueError) as problem:  # a loop of links, no permission, a null byte in the name
        raise _not_read(path, problem) from None
    try:
        _require_a_file(path, os.fstat(descriptor).st_mode)
    except UnreadableError:  # it was another one a moment ago
        os.close(descriptor)
        raise
    return descriptor


def _require_no_way_out(path: Path) -> None:
    if path.is_symlink() and path.resolve().parent != path.parent.resolve():
        raise UnreadableError(f"{path.name} is a link to a file outside its folder. Hand in the file itself.")


def _require_a_file(path: Path, mode: int) -> None:
    if stat.S_ISDIR(mode):
        raise UnreadableError(f"{path.name or path} is a folder. Name the .py or .ipynb file in it.")
    if not stat.S_ISREG(mode):
        raise UnreadableError(f"{path.name} is not an ordinary file. Hand in a .py or .ipynb file.")


def _read(descriptor: int, most: int, path: Path) -> bytes:
    try:
        return os.read(descriptor, most)
    except OSError as problem:
        raise _not_read(path, problem) from None


def _not_read(path: Path, problem: Exception) -> UnreadableError | GradingError:
    fault = GradingError if getattr(problem, "errno", None) in _OF_THE_MACHINE else UnreadableError
    return fault(f"{path.name} cannot be read: {getattr(problem, 'strerror', None) or problem}.")


def _too_large(path: Path) -> str:
    if kind_of_file(path.name) == PROGRAM:
        return f"{path.name} is larger than {LARGEST // 1024} kB. Hand in only the program."
    return f"{path.name} is larger than {LARGEST_NOTEBOOK // _MB} MB. Clear its outputs and save it again."


def readable(name: str) -> str:
    """A file's name or path as text, whatever bytes it is of and whatever the locale made of them.

    A program with a name that is no text does not start: rclpy refuses it among the arguments.
    """
    try:
        return os.fsencode(name).decode(errors="replace")
    except UnicodeEncodeError:  # typed by somebody whose locale has no such letters
        return name.encode(errors="replace").decode()
