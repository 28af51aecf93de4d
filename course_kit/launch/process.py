"""One child of a launch: its output by lines, and its end in three steps."""

from __future__ import annotations

import contextlib
import ctypes
import os
import shlex
import signal
import subprocess
from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

_PR_SET_PDEATHSIG = 1  # see prctl(2)
_CHUNK = 65536
# What a child is sent, and how many seconds it gets before the next; the real launch's defaults.
STEPS = ((signal.SIGINT, 5.0), (signal.SIGTERM, 5.0), (signal.SIGKILL, 5.0))


class Child:
    """A process of a launch file.

    Args:
        command: what to run.
        label: how its lines are marked, such as "parameter_node.py-1".
        environ: its environment.
        show_stdout: whether its stdout belongs on the screen; stderr always does.
        temporary: files that are its own.
        inherits: file descriptors it gets, and with them our own stdout and stderr, which it writes to directly.

    Attributes:
        stop_step: how many of `STEPS` have been taken.
    """

    def __init__(  # noqa: PLR0913 - a process is described by that much
        self,
        command: list[str],
        label: str,
        environ: dict[str, str],
        *,
        show_stdout: bool,
        temporary: list[Path],
        inherits: tuple[int, ...] | None = None,
    ) -> None:
        self.label, self._temporary = label, temporary
        self.command = shlex.join(command)
        self.stop_step, self.stop_at = 0, 0.0
        libc, parent = ctypes.CDLL(None), os.getpid()

        def die_with_launch() -> None:
            """In the child: when launch is killed outright, so is it."""
            libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != parent:
                os.kill(os.getpid(), signal.SIGKILL)

        self._process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE if inherits is None else None if show_stdout else subprocess.DEVNULL,
            stderr=subprocess.PIPE if inherits is None else None,
            pass_fds=inherits or (),
            env=environ,
            start_new_session=True,  # a Ctrl-C reaches launch alone, which passes it on once
            preexec_fn=die_with_launch,  # noqa: PLW1509 - launch has one thread
        )
        self.streams: dict[IO[bytes], tuple[bytearray, bool]] = {}
        for stream, shown in ((self._process.stdout, show_stdout), (self._process.stderr, True)):
            if stream is not None:
                os.set_blocking(stream.fileno(), False)
                self.streams[stream] = (bytearray(), shown)

    @property
    def process_id(self) -> int:
        """The process id."""
        return self._process.pid

    def read(self, stream: IO[bytes], take: Callable[[str, bool], None]) -> bool:
        """Hand on the whole lines there are, with whether they are shown; False at the end of the stream."""
        pending, shown = self.streams[stream]
        try:
            chunk = os.read(stream.fileno(), _CHUNK)
        except BlockingIOError:
            return True
        pending += chunk
        *lines, rest = bytes(pending).split(b"\n")
        if not chunk and rest:  # a last line without an end
            lines, rest = [*lines, rest], b""
        pending[:] = rest
        for line in lines:
            take(line.decode(errors="replace").rstrip("\r"), shown)
        return bool(chunk)

    def exit_code(self) -> int | None:
        """The exit code, negative for a signal; None while it runs."""
        return self._process.poll()

    def send(self, number: signal.Signals) -> None:
        """Signal the process and what it has started."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, number)

    def clean_up(self) -> None:
        """End what is left of its group, close its streams and remove its files."""
        self.send(signal.SIGKILL)
        for stream in self.streams:
            stream.close()
        for path in self._temporary:
            path.unlink(missing_ok=True)
