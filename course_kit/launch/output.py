"""Where a launch writes: the screen, and a log file of its own; and how signals reach it."""

from __future__ import annotations

import contextlib
import os
import platform
import signal
import sys
import time
from typing import IO, TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD)


@contextlib.contextmanager
def log_file() -> Iterator[IO[str]]:
    """The log of one launch among the logs of ROS; the first lines on the screen say where."""
    environment.apply()
    from pathlib import Path

    folder = Path(os.environ.get("ROS_LOG_DIR") or f"{os.environ['ROS_HOME']}/log")  # one of them is set by now
    folder.mkdir(parents=True, exist_ok=True)
    stamp = time.strftime("%Y-%m-%d-%H-%M-%S")
    with (folder / f"{stamp}-{platform.node()}-{os.getpid()}.launch.log").open("w", encoding="utf-8") as log:
        sys.stdout.write(f"[INFO] [launch]: All log files can be found below {folder}\n")
        sys.stdout.write("[INFO] [launch]: Default logging verbosity is set to INFO\n")
        sys.stdout.flush()
        yield log


@contextlib.contextmanager
def signals_as_bytes() -> Iterator[int]:
    """The descriptor from which signals can be read, so that they come between two steps and never inside one."""
    woken, wake = os.pipe()
    os.set_blocking(wake, False)
    before = {number: signal.signal(number, lambda *_: None) for number in _SIGNALS}
    wakeup = signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    try:
        yield woken
    finally:
        signal.set_wakeup_fd(wakeup)
        for number, handler in before.items():
            signal.signal(number, handler)
        os.close(woken)
        os.close(wake)
