"""The reader, seen from whoever trusts it: one small process that turns submissions into programs, within limits.

Its own side is `course_kit.reader`. It is safe to use from a Jupyter kernel: nothing is forked here.
"""

from __future__ import annotations

import json
import os
import select
import signal
import socket
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import course_kit
from course_kit.grading.errors import GradingError
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import reading_answers as answers
from course_kit.process import Closable
from course_kit.process.child import INTO_STDOUT, Child
from course_kit.process.libc import make_memory_file
from course_kit.process.output import LastWords
from course_kit.reader import contract
from course_kit.reader.text import NOTEBOOK, kind_of_file

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.model.submission import Copy, Submission
    from course_kit.grading.reading.reading_answers import Look

# No folder but the kit's own and the standard library's is looked at for modules, whatever lies in them.
_START = "import sys; sys.path.append(sys.argv.pop()); from course_kit.reader.process import main; main()"
_TOO_MUCH_MEMORY = 69  # exit status of the reader's child
_LOOK_S = 0.1  # how often it is asked whether somebody has pressed Ctrl-C
_GRACE_S = 15.0  # beyond its own deadline; a reader that is later than that hangs, by a fault of ours
_END_S = 2.0
_TRIES = 2  # a reader that another program has ended gets a successor


class ReadingStoppedError(Exception):
    """Somebody has asked to stop."""


class Reader(Closable):
    """The process. For one thread at a time."""

    def __init__(self, stopped: Callable[[], bool] = lambda: False) -> None:
        """Start it; it gets ready while the caller goes on."""
        self._stopped = stopped
        self._start()

    def read(self, copy: Copy, exercise: Exercise) -> Submission:
        """The program that somebody has handed in for an exercise."""
        told = self._ask(copy, exercise, whatever=True)
        if told["unreadable"]:
            raise UnreadableError(str(told["unreadable"]))
        return answers.submission(copy, told)

    def look(self, copy: Copy, exercise: Exercise, *, whatever: bool = False) -> Look:
        """What a file looks like, and its program where that is asked for, or `whatever` it is."""
        return answers.look(copy, self._ask(copy, exercise, whatever=whatever))

    def close(self) -> None:
        """End it. Safe to call twice."""
        self._line.close()  # it notices, ends what it has under way, and stops
        self._process.wait_or_kill(_END_S)
        self._said.file.close()

    def _start(self) -> None:
        try:
            self._line, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            self._said = LastWords()
            with theirs:
                root = Path(course_kit.__file__).resolve().parent.parent
                self._process = Child(
                    [sys.executable, "-I", "-S", "-W", "ignore", "-c", _START, str(theirs.fileno()), str(root)],
                    folder="/",
                    stdout=self._said.file,
                    stderr=INTO_STDOUT,
                    descriptors=[theirs.fileno()],
                )
        except OSError as problem:
            raise GradingError(f"The process that reads submissions could not start: {problem.strerror}.") from problem

    def _ask(self, copy: Copy, exercise: Exercise, *, whatever: bool) -> Record:
        request = {
            "name": copy.name,
            "exercise": exercise.id,
            "class_name": exercise.class_name,
            "variable": exercise.variable,
            "whatever": whatever,
        }
        if self._stopped():
            raise ReadingStoppedError
        for _ in range(_TRIES):
            try:
                ended, answer = self._exchange(request, copy)
            except (EOFError, ValueError, OSError):  # another program has ended it
                pass
            else:
                if self._understood(copy, ended):
                    return _checked(answer)
            words = self._said.last_line()
            self.close()
            self._start()
        raise GradingError(f"The process that reads submissions ended while it was reading. {words}".strip())

    def _exchange(self, request: Record, copy: Copy) -> tuple[Record, bytes]:
        """How the reader's child has ended, and what it has written."""
        with _file_in_memory() as answer:
            contract.send_packet(self._line, request, (copy.fileno(), answer.fileno()))
            ended = self._await_end()
            answer.seek(0)
            return ended, answer.read(contract.ANSWER_BYTES)

    def _await_end(self) -> Record:
        """How the reader's child has ended."""
        deadline = time.monotonic() + contract.WALL_S + _GRACE_S
        poll = select.poll()
        poll.register(self._line, select.POLLIN)
        while not poll.poll(_LOOK_S * 1000):
            if self._stopped():
                raise ReadingStoppedError
            if time.monotonic() > deadline:
                self._process.kill()
                raise EOFError("the reader hangs")
        return contract.receive_packet(self._line)[0]

    def _understood(self, copy: Copy, ended: Record) -> bool:
        """Whether there is an answer; False when the child was ended by somebody else, or has failed."""
        status, cpu_s = int(ended["status"]), float(ended["cpu_s"])
        ended_by = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        used_up = cpu_s >= contract.CPU_S - 1
        advice = "Clear its outputs and hand" if kind_of_file(copy.name) == NOTEBOOK else "Hand"
        advice += " in a shorter, simpler program."
        if ended_by == signal.SIGXCPU or (ended_by and used_up):
            raise UnreadableError(
                f"{copy.name} cannot be read: Python needs more than {contract.CPU_S} s of computing for it. {advice}"
            )
        if ended["late"]:
            raise GradingError(f"The machine was too busy: {copy.name} was not read within {contract.WALL_S:g} s.")
        if ended_by in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS):
            raise UnreadableError(
                f"{copy.name} cannot be read: Python crashes on it because something is nested too deeply. {advice}"
            )
        if os.WIFEXITED(status) and os.WEXITSTATUS(status) == _TOO_MUCH_MEMORY:
            raise UnreadableError(
                f"{copy.name} cannot be read: Python needs more than {contract.MEMORY_MB} MB of memory for it. {advice}"
            )
        return status == 0


def _file_in_memory() -> BinaryIO:
    """A file nobody else knows."""
    try:
        return open(make_memory_file("reader"), "w+b", buffering=0)  # noqa: PTH123 - a descriptor
    except OSError as problem:
        raise GradingError(f"A submission could not be read: {problem.strerror}.") from problem


def _checked(answer: bytes) -> Record:
    """What a child has written."""
    try:
        told = json.loads(answer)
    except (ValueError, RecursionError):
        told = None
    if not isinstance(told, dict):
        raise GradingError("The process that reads submissions sent an answer that makes no sense.")
    return told
