"""One program as a child process, and the pipes to it."""

from __future__ import annotations

import contextlib
import os
import re
from typing import TYPE_CHECKING

from course_kit.lab.errors import ScriptError

if TYPE_CHECKING:
    import signal
    import subprocess
    import threading


class Script:
    """A running program.

    Attributes:
        name: what the learner calls it.
        process: the child.
        nodes: fully qualified names of the nodes it has made.
        spins: "server" or "client" once its nodes are being spun.
        stopping: whether we have asked it to end.
        follower: the thread that waits for its end.
    """

    def __init__(self, name: str, process: subprocess.Popen[bytes]) -> None:
        self.name = name
        self.process = process
        self.nodes: list[str] = []
        self.spins = ""
        self.stopping = False
        self.follower: threading.Thread | None = None

    @property
    def running(self) -> bool:
        """Whether it has not ended."""
        return self.process.poll() is None

    def __repr__(self) -> str:
        if self.running:
            return f"{self.name} is running."
        code = self.process.returncode
        return f"{self.name} has ended." if code == 0 or self.stopping else f"{self.name} ended with exit code {code}."

    def signal(self, number: signal.Signals) -> None:
        """Send a signal to it and to all it has started."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self.process.pid, number)


def pipe() -> tuple[int, int]:
    """A pipe whose reading end never blocks; the writing end reaches only children that are given it."""
    reading, writing = os.pipe()
    os.set_blocking(reading, False)
    return reading, writing


def checked_name(name: str) -> str:
    """The name without ".py"; raises ScriptError for one that cannot be a file's."""
    bare = name.removesuffix(".py")
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", bare):
        raise ScriptError(f"{name!r} cannot name a script: use letters, digits and underscores, such as server.")
    return bare
