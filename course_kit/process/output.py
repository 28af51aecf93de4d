"""What a child process prints: handed on line by line, or kept for the day on which it fails."""

from __future__ import annotations

import fcntl
import os
from contextlib import suppress

from course_kit.process.libc import make_memory_file


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


class LastWords:
    """A file in memory for what a child prints that has nothing to say: as a rule, why it has failed."""

    _MOST = 2000  # bytes

    def __init__(self) -> None:
        self.file = open(make_memory_file("last words"), "w+b", buffering=0)  # noqa: PTH123, SIM115 - a descriptor

    def last_line(self) -> str:
        """What it has printed last; nothing when the file is closed."""
        with suppress(ValueError, OSError):  # the latter where another thread closes it just now
            descriptor = self.file.fileno()
            end = os.pread(descriptor, self._MOST, max(os.fstat(descriptor).st_size - self._MOST, 0))
            return end.decode("utf-8", errors="replace").strip().rpartition("\n")[2]
        return ""
