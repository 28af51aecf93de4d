"""Submissions become text: the bytes of files are copied and counted, and one small process reads them within limits.

They are a stranger's: the process's own side is `course_kit.reader`. It is safe to use from a Jupyter kernel: nothing
is forked here.
"""

from __future__ import annotations

import errno
import hashlib
import io
import json
import os
import signal
import socket
import stat
import sys
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import course_kit
from course_kit.grading.errors import GradingError
from course_kit.grading.model.plain_data import Record, convert_record
from course_kit.grading.model.submission import Submission, UnreadableError
from course_kit.process import Closable
from course_kit.process.child import QuietChild
from course_kit.process.libc import make_memory_file
from course_kit.reader import files, process
from course_kit.reader.files import ARCHIVE, YAML
from course_kit.reader.python import MEMORY_MB
from course_kit.reader.text import LARGEST, NOTEBOOK, PROGRAM, kind_of_file

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.model.exercise import Exercise

_MB = 1 << 20
LARGEST_NOTEBOOK = 64 * _MB  # bytes of a notebook's file, most of them outputs
_LARGEST = {PROGRAM: LARGEST, YAML: LARGEST, NOTEBOOK: LARGEST_NOTEBOOK, ARCHIVE: LARGEST_NOTEBOOK}
_MOST_FILES = 1000  # in a folder with everything that lies below it
# Rights belong to whoever grades: a file that was closed to them, perhaps by another submission, is nobody's zero.
_OF_THE_MACHINE = {errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EIO, errno.EACCES, errno.EPERM, errno.ESTALE}
# No folder but the kit's own and the standard library's is looked at for modules, whatever lies in them.
_START = "import sys; sys.path.append(sys.argv.pop()); from course_kit.reader.process import main; main()"
_GRACE_S = 15.0  # beyond its own deadline
_END_S = 2.0
_TRIES = 2  # a reader that another program has ended gets a successor


class Copy(io.FileIO):
    """A copy of a submission's file in memory: its name, its size in bytes, and SHA-256 of its kind and bytes."""

    name: str

    def __init__(self, name: str, size: int, digest: str, data: bytes) -> None:
        super().__init__(make_memory_file("submission"), "wb")
        self.name, self.size, self.digest = name, size, digest
        self.write(data)


def copy_file(path: Path, *, whole: bool = True, several: bool = False) -> Copy:
    """Copy a file; or, where an exercise asks for several, those of a folder as a zip archive."""
    try:
        if several and path.is_dir():
            return _pack_folder(path)
        ending = kind_of_file(path.name) or (path.suffix.lower() if several else "")
        most = _LARGEST.get(ending, 0)
        data = _read_bytes(path, most + 1)
        if ending not in (_LARGEST if several else (PROGRAM, NOTEBOOK)):
            raise UnreadableError(f"{path.name} is neither a .py nor an .ipynb file. Hand in one of these.")
        if len(data) > most and whole:
            raise UnreadableError(
                f"{path.name} is larger than {LARGEST // 1024} kB. Hand in only the program."
                if ending == PROGRAM
                else f"{path.name} is larger than {LARGEST_NOTEBOOK // _MB} MB. Clear its outputs and save it again."
            )
        digest = hashlib.sha256(ending.encode() + b"\0" + data[:most]).hexdigest()
        return Copy(path.name or path.absolute().name, len(data), digest, data[:most])
    except OSError as problem:  # what concerns the file itself is an UnreadableError
        raise GradingError(f"A submission could not be read: {problem.strerror}.") from problem


def _pack_folder(folder: Path) -> Copy:
    """The programs, parameter files and notebooks below a folder, but for hidden folders: see `reader.files`."""
    import zipfile

    size, packed = 0, io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for place, folders, names in os.walk(folder):
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            for path in (Path(place, name) for name in sorted(names) if Path(name).suffix in (PROGRAM, YAML, NOTEBOOK)):
                data = _read_bytes(path, LARGEST_NOTEBOOK + 1 - size)
                size += len(data)
                if size > LARGEST_NOTEBOOK or len(archive.filelist) == _MOST_FILES:
                    limits = f"{_MOST_FILES} files, or {LARGEST_NOTEBOOK // _MB} MB"
                    raise UnreadableError(f"{folder.name} holds more than {limits}. Name the folder of your answer.")
                name = path.relative_to(folder).as_posix().encode(errors="replace").decode()
                archive.writestr(zipfile.ZipInfo(name), data)
    digest = hashlib.sha256(packed.getvalue()).hexdigest()  # the same for the same files
    return Copy((folder.name or folder.absolute().name) + ARCHIVE, size, digest, packed.getvalue())


def _read_bytes(path: Path, most: int) -> bytes:
    """The first bytes of an ordinary file."""
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
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        if stat.S_ISDIR(mode):
            raise UnreadableError(f"{path.name or path} is a folder. Name the .py or .ipynb file in it.")
        raise UnreadableError(f"{path.name} is not an ordinary file. Hand in a .py or .ipynb file.")
    try:
        with open(descriptor, "rb") as file:  # noqa: PTH123 - a descriptor
            return file.read(most)
    except OSError as problem:
        raise _not_read(path, problem) from None


def _not_read(path: Path, problem: Exception) -> UnreadableError | GradingError:
    fault = GradingError if getattr(problem, "errno", None) in _OF_THE_MACHINE else UnreadableError
    return fault(f"{path.name} cannot be read: {getattr(problem, 'strerror', None) or problem}.")


class ReadingStoppedError(Exception):
    """Somebody has asked to stop."""


@dataclass(frozen=True)
class FileSummary:
    """What a file that may be a submission holds."""

    found: bool = False  # whether that is what the exercise asks for
    identity: str = ""  # equal for programs that differ in comments and blanks alone, or ""
    imports: frozenset[str] = frozenset()
    prints: frozenset[int] = frozenset()  # hashes of short runs of the program's tokens, see `reader.fingerprints`
    unreadable: str = ""  # why no program can be read
    program: Submission | None = None  # unless none can be read


Memory: TypeAlias = dict[tuple[str, str, str], FileSummary]  # by the file's name and bytes and the exercise


class Reader(Closable):
    """The process, which runs from the first file on; for one thread at a time."""

    def __init__(self, stopped: Callable[[], bool] = lambda: False, *, memory: Memory | None = None) -> None:
        self._stopped = stopped
        self.memory: Memory = {} if memory is None else memory  # of what has been read
        self._process: QuietChild | None = None

    def read(self, copy: Copy, exercise: Exercise) -> Submission:
        """The program that somebody has handed in for an exercise."""
        summary = self.memory.get((copy.name, copy.digest, exercise.id)) or self._ask(copy, exercise)
        if summary.program is None:
            raise UnreadableError(summary.unreadable)
        return summary.program

    def summarize(self, copy: Copy, exercise: Exercise) -> FileSummary:
        """What a file holds; that is remembered."""
        key = (copy.name, copy.digest, exercise.id)
        if key not in self.memory:
            self.memory[key] = self._ask(copy, exercise)
        return self.memory[key]

    def close(self) -> None:
        """End the process; what is remembered stays. Safe to call twice."""
        if self._process is not None:
            self._line.close()  # it notices, ends what it has under way, and stops
            self._process.wait_or_kill(_END_S)
            self._process = None

    def start(self) -> QuietChild:
        """Start the process; it gets ready while the caller goes on."""
        try:
            self._line, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            self._line.settimeout(process.WALL_S + _GRACE_S)  # what is later than that hangs, by a fault of ours
            with theirs:
                root = Path(course_kit.__file__).resolve().parent.parent
                command = [sys.executable, "-I", "-S", "-W", "ignore", "-c", _START, str(theirs.fileno()), str(root)]
                self._process = QuietChild(command, [theirs.fileno()])
                return self._process
        except OSError as problem:
            raise GradingError(f"The process that reads submissions could not start: {problem.strerror}.") from problem

    def _ask(self, copy: Copy, exercise: Exercise) -> FileSummary:
        names = {"exercise": exercise.id, "class_name": exercise.class_name, "variable": exercise.variable}
        request = {"name": copy.name, "files": exercise.files, **names}
        if self._stopped():
            raise ReadingStoppedError
        words = ""
        for _ in range(_TRIES):
            process = self._process or self.start()
            with suppress(EOFError, OSError):  # another program has ended it
                ended, answer = self._exchange(request, copy)
                if self._has_answer(copy, ended):
                    return _summary(copy, answer)
            words = process.last_line()
            self.close()
        raise GradingError(f"The process that reads submissions ended while it was reading. {words}".strip())

    def _exchange(self, request: Record, copy: Copy) -> tuple[Record, bytes]:
        """How the reader's child has ended, and what it has written."""
        with open(make_memory_file("reader"), "w+b", buffering=0) as answer:  # noqa: PTH123 - a descriptor
            process.send_packet(self._line, request, (copy.fileno(), answer.fileno()))
            ended, _ = process.receive_packet(self._line)
            answer.seek(0)
            return ended, answer.read(process.ANSWER_BYTES)

    def _has_answer(self, copy: Copy, ended: Record) -> bool:
        """Whether there is an answer; False when the child was ended by somebody else, or has failed."""
        status, cpu_s = int(ended["status"]), float(ended["cpu_s"])
        ended_by = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        used_up = ended_by == signal.SIGXCPU or (ended_by and cpu_s >= process.CPU_S - 1)
        if ended["late"] and not used_up:
            raise GradingError(f"The machine was too busy: {copy.name} was not read within {process.WALL_S:g} s.")
        if used_up:
            why = f"Python needs more than {process.CPU_S} s of computing for it"
        elif ended_by in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS):
            why = "Python crashes on it because something is nested too deeply"
        elif os.WIFEXITED(status) and os.WEXITSTATUS(status) == process.TOO_MUCH_MEMORY:
            why = f"Python needs more than {MEMORY_MB} MB of memory for it"
        else:
            return status == 0
        advice = "Clear its outputs and hand" if kind_of_file(copy.name) == NOTEBOOK else "Hand"
        raise UnreadableError(f"{copy.name} cannot be read: {why}. {advice} in a shorter, simpler program.")


def _summary(copy: Copy, answer: bytes) -> FileSummary:
    """What a child has written, which has read what a stranger wrote."""
    try:
        fields = json.loads(answer)  # not by msgspec, which takes no text with half a character
        if fields.get("program"):
            fields["program"].update(name=copy.name, program=_program_name(copy.name))
            if not all(map(files.is_name, fields["program"].get("files", ()))):
                raise ValueError("a file's name")  # noqa: TRY301 - as for all that makes no sense
        return convert_record(fields, FileSummary)
    except (ValueError, AttributeError, RecursionError):
        raise GradingError("The process that reads submissions sent an answer that makes no sense.") from None


def _program_name(name: str) -> str:
    """A name to run under, which stands in tracebacks as it is: `a b.py` for `a b.ipynb`."""
    stem = name
    while kind_of_file(stem):  # `a.py` of `a.py.txt`, then `a`
        stem = stem.rpartition(".")[0]
    return "".join(letter if letter.isprintable() and letter not in '"\\/' else "_" for letter in stem) + ".py"


def starter_identities(exercise: Exercise) -> frozenset[str]:
    """Those of the programs that an exercise begins with: whoever hands one in as it was has not begun."""
    programs = exercise.folder if exercise.files else exercise.folder / exercise.starter
    paths = (programs, exercise.folder / exercise.notebook)
    return frozenset(filter(None, (_identity_of(path, exercise.id, exercise.files) for path in paths)))


@lru_cache(maxsize=64)
def _identity_of(path: Path, exercise_id: str, wanted: tuple[str, ...]) -> str:
    """That of a file of the course, read here: whoever kills the reader must not make a starter an answer."""
    with suppress(UnreadableError, GradingError), copy_file(path, several=bool(wanted)) as copy:
        wish = {"exercise": exercise_id, "files": wanted, "class_name": "", "variable": ""}
        file = io.BytesIO(os.pread(copy.fileno(), os.fstat(copy.fileno()).st_size, 0))
        return str(process.look_at(copy.name, file, wish)["identity"])
    return ""
