"""Child processes: how one is started, waited for and ended, by SIGKILL at last, what it prints; and forks."""

from __future__ import annotations

import ctypes
import fcntl
import gc
import math
import os
import subprocess
import sys
import time
from contextlib import suppress
from signal import SIGINT, SIGKILL, SIGTERM, Signals
from typing import IO, TYPE_CHECKING

from course_kit.process.libc import die_with_parent, make_memory_file

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

PIPE, INTO_STDOUT, NOWHERE = subprocess.PIPE, subprocess.STDOUT, subprocess.DEVNULL
# Of ld.so(8): to start a process with that is forked again and again: no fork has to bind.
BOUND_AT_ONCE = {"LD_BIND_NOW": "1"}
_KILLED_S = 10.0  # the kernel needs some to end a process that is large, or busy with a disk


class Ladder:
    """The signals that one process gets, one after the other, and how long it has to obey each."""

    def __init__(self, interrupt_s: float, terminate_s: float, kill_s: float) -> None:
        self.left = [(SIGINT, interrupt_s), (SIGTERM, terminate_s), (SIGKILL, kill_s)]
        self.climbed: list[tuple[Signals, float]] = []
        self._next_at = math.inf

    def take_signal(self) -> tuple[Signals, float]:
        """The next signal, for the caller to send now, and the seconds that the process has from now on."""
        self.climbed.append(self.left.pop(0))
        self._next_at = time.monotonic() + self.climbed[-1][1] if self.left else math.inf
        return self.climbed[-1]

    def pause_s(self) -> float:
        """Seconds until it is time for the next signal; infinite before the first and after the last."""
        return max(0.0, self._next_at - time.monotonic())


class Child:
    """A process in its own session, with nothing to read: a command, or a fork that runs a function and ends."""

    def __init__(  # noqa: PLR0913 - a process is described by that much
        self,
        command: Sequence[str],
        *,
        environ: Mapping[str, str] | None = None,
        folder: str | Path | None = None,
        stdout: int | IO[bytes] | None = None,
        stderr: int | IO[bytes] | None = None,
        descriptors: Sequence[int] = (),
        dies_with_us: bool = False,
        run: Callable[[], object] | None = None,  # its first step is to close what it has inherited: we wait for that
    ) -> None:
        us = os.getpid()
        self._popen = subprocess.Popen(
            list(command),
            env=environ,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=stdout,
            stderr=stderr,
            pass_fds=descriptors,
            start_new_session=True,
            preexec_fn=run or ((lambda: die_with_parent(us)) if dies_with_us else None),  # noqa: PLW1509 - see above
        )
        self.pid, self.stdout, self.stderr = self._popen.pid, self._popen.stdout, self._popen.stderr

    def exit_code(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        return self._popen.poll()

    def wait(self, seconds: float | None = None) -> int | None:
        """Wait until it has ended; its exit code, None if it has not within so many seconds."""
        with suppress(subprocess.TimeoutExpired):
            return self._popen.wait(seconds)
        return None

    def send(self, number: Signals) -> None:
        """Signal it and what it has started."""
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, number)

    def end(self, ladder: Ladder) -> bytes:
        """Have it end, by SIGKILL at the latest, and kill what it has started and left behind."""
        data = b""
        while ladder.left:
            number, seconds = ladder.take_signal()
            self.send(number)
            with suppress(subprocess.TimeoutExpired):
                data, _ = self._popen.communicate(timeout=seconds)  # who waits for a full pipe to be read does not end
                break
        self.kill()
        return data or b""

    def wait_or_kill(self, seconds: float) -> int:
        """Its exit code; it is killed when it has not ended by itself within so many seconds."""
        code = self.wait(seconds)
        return self.kill() if code is None else code

    def kill(self) -> int:
        """Kill it, or what it has left behind, and read no more of its output; its exit code."""
        self.send(SIGKILL)
        code = self.wait(_KILLED_S)
        for stream in (self.stdout, self.stderr):
            if stream is not None:
                stream.close()
        return -SIGKILL if code is None else code


class LineReader:
    """The lines that come through a pipe, as far as they are there: its other end is never waited for."""

    def __init__(self, descriptor: int) -> None:
        """Take over our end of a pipe, which remains the caller's to close."""
        os.set_blocking(descriptor, False)
        self._descriptor = descriptor
        self._capacity = fcntl.fcntl(descriptor, fcntl.F_GETPIPE_SZ)
        self._unfinished = b""
        self.ended = False

    def read(self) -> list[str]:
        """All whole lines written so far, without their ends; with the end of the stream also one that has no end."""
        try:
            data = os.read(self._descriptor, self._capacity)
        except BlockingIOError:
            return []
        self.ended = not data
        *lines, self._unfinished = (self._unfinished + data).split(b"\n")
        return [line.decode(errors="replace") for line in lines] + (self.take_rest() if self.ended else [])

    def take_rest(self) -> list[str]:
        """The line that has no end yet, when it will get none; nothing where the last one is whole."""
        rest, self._unfinished = self._unfinished, b""
        return [rest.decode(errors="replace")] if rest else []


class QuietChild(Child):
    """A process of ours that has nothing to say; what it prints all the same is, as a rule, why it has failed."""

    _MOST = 2000  # bytes

    def __init__(
        self, command: Sequence[str], descriptors: Sequence[int], environ: Mapping[str, str] | None = None
    ) -> None:
        self._said = open(make_memory_file("last words"), "w+b", buffering=0)  # noqa: PTH123, SIM115 - a descriptor
        super().__init__(
            command, environ=environ, folder="/", stdout=self._said, stderr=INTO_STDOUT, descriptors=descriptors
        )

    def last_line(self) -> str:
        """What it has printed last; nothing when it was waited for to the end."""
        with suppress(ValueError, OSError):  # the latter where another thread closes the file just now
            descriptor = self._said.fileno()
            end = os.pread(descriptor, self._MOST, max(os.fstat(descriptor).st_size - self._MOST, 0))
            return end.decode("utf-8", errors="replace").strip().rpartition("\n")[2]
        return ""

    def wait_or_kill(self, seconds: float) -> int:
        """See `Child`; its last words are forgotten."""
        code = super().wait_or_kill(seconds)
        self._said.close()
        return code


def fork_child(run: Callable[[], object]) -> int:
    """Fork, and have the child run a function and end."""
    if child := os.fork():
        return child
    status = 1
    try:
        run()
        status = 0
    except BaseException:  # noqa: BLE001 - whatever it is ends the child; the parent learns of it by the status
        sys.excepthook(*sys.exc_info())
    finally:
        os._exit(status)


def freeze_memory() -> None:
    """Give back what importing left unused, a fifth of the memory, and keep forks from copying what they look at."""
    if trim := getattr(ctypes.CDLL(None), "malloc_trim", None):  # of glibc
        trim(ctypes.c_size_t(0))
    gc.freeze()
