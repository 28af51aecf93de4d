"""Programs whose output is read while they run, for the benchmarks that start strangers' programs and commands."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

ROS2 = [sys.executable, "-m", "course_kit.ros2cli"]
_GRACE_S = 5.0


class Program:
    """A running program.

    Args:
        command: its words.
        folder: where it runs.
        environ: its environment.

    Attributes:
        output: what it has printed, stdout and stderr.
    """

    def __init__(self, command: list[str], folder: Path, environ: dict[str, str]) -> None:
        self.output = ""
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            env=environ,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self._process.stdout or ():
            self.output += line

    def prints(self, wanted: str, seconds: float, *, until_end: bool = False) -> bool:
        """Whether it prints something before it ends, or time is up.

        Args:
            wanted: a pattern of what it is to print.
            seconds: the time.
            until_end: whether it is to end, too.
        """
        ends = time.monotonic() + seconds
        while time.monotonic() < ends and self.is_running():
            if not until_end and re.search(wanted, self.output):
                return True
            time.sleep(0.05)
        self._reader.join(0 if self.is_running() else _GRACE_S)
        return bool(re.search(wanted, self.output)) and not (until_end and self.is_running())

    def is_running(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def stop(self) -> None:
        """Ctrl-C, and an end by force for what goes on."""
        for sign in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if not self.is_running():
                break
            os.killpg(self._process.pid, sign)
            try:
                self._process.wait(_GRACE_S)
            except subprocess.TimeoutExpired:
                continue
        self._reader.join(_GRACE_S)
