"""Runs a launch file: starts its processes, passes their output on, and sees that all of them end."""

from __future__ import annotations

import contextlib
import os
import platform
import selectors
import signal
import sys
import time
from typing import IO, TYPE_CHECKING

from course_kit import environment
from course_kit.launch.actions import execute_all
from course_kit.launch.context import LaunchContext
from course_kit.launch.description import load
from course_kit.launch.errors import LaunchError
from course_kit.launch.process import LaunchedProcess

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD)
_ALWAYS_CHECK = 1.0  # seconds; a signal wakes the loop, this is for what no signal tells


class LaunchService:
    """One run of a launch file, in the main thread.

    Args:
        log: where everything is written down, also what is not shown.
    """

    def __init__(self, log: IO[str]) -> None:
        self._log = log
        self._children: list[LaunchedProcess] = []
        self._started = 0
        self._timers: list[tuple[float, list[object], LaunchContext]] = []
        self._selector = selectors.DefaultSelector()
        self._stopping = False
        self._environ = environment.child_environment(PYTHONUNBUFFERED="1")

    def run(self, file: Path, arguments: dict[str, str]) -> int:
        """Run until all processes have ended and no timer is left.

        Returns:
            The exit code: 0, whatever became of the processes, as with the real launch.

        Raises:
            LaunchError: the file cannot be run; everything it had started has ended.
        """
        with self._signals() as woken:
            try:
                execute_all(load(file).entities, LaunchContext(dict(arguments), file), self)
                while self._children or (self._timers and not self._stopping):
                    self._wait(woken)
                    self._fire_timers()
                    self._escalate()
                    self._reap()
            finally:
                self._end_all(woken)
        return 0

    # What actions ask

    def start(self, command: list[str], label: str, *, show_stdout: bool, temporary: list[Path]) -> None:
        """Start a process; its temporary files are removed when it has ended.

        Args:
            command: the program and its arguments.
            label: what its lines begin with.
            show_stdout: whether these are shown or only logged.
            temporary: files to remove when all is over.

        Raises:
            LaunchError: it cannot be started.
        """
        self._started += 1
        try:
            child = self.make_child(command, f"{label}-{self._started}", show_stdout=show_stdout, temporary=temporary)
        except OSError as error:
            raise LaunchError(f"{command[0]} cannot be started: {error.strerror}.") from error
        self._children.append(child)
        for stream in child.streams:
            self._selector.register(stream, selectors.EVENT_READ, (child, stream))
        self.say(f"[INFO] [{child.label}]: process started with pid [{child.process.pid}]")

    def make_child(
        self, command: list[str], label: str, *, show_stdout: bool, temporary: list[Path]
    ) -> LaunchedProcess:
        """Start a process whose output comes through us.

        Args:
            command: see `start`.
            label: what its lines begin with.
            show_stdout: see `start`.
            temporary: see `start`.
        """
        return LaunchedProcess(command, label, self._environ, show_stdout=show_stdout, temporary=temporary)

    def later(self, seconds: float, actions: list[object], context: LaunchContext) -> None:
        """Run actions after a while.

        Args:
            seconds: when.
            actions: what.
            context: of the launch.
        """
        self._timers.append((time.monotonic() + seconds, actions, context))

    def say(self, text: str, *, shown: bool = True) -> None:
        """Write a line to the log, and to the screen if it is to be shown."""
        self._log.write(f"{text}\n")
        self._log.flush()
        if shown:
            sys.stdout.write(f"{text}\n")
            sys.stdout.flush()

    # The loop

    def _wait(self, woken: int) -> None:
        due = [max(0.0, at - time.monotonic()) for at, _, _ in self._timers]
        left = min([*due, *(child.ladder.pause_s() for child in self._children), _ALWAYS_CHECK])
        for key, _ in self._selector.select(left):
            if key.fd == woken:
                self._take_signals(os.read(woken, 100))
            else:
                self._take_output(*key.data)

    def _take_output(self, child: LaunchedProcess, stream: IO[bytes]) -> None:
        lines, shown = child.streams[stream]
        for line in lines.read():
            text = line.rstrip("\r")
            self.say(f"[{child.label}] {text}", shown=shown)
        if lines.ended:
            self._selector.unregister(stream)

    def _take_signals(self, numbers: bytes) -> None:
        if signal.SIGINT in numbers:
            again = " again, ignoring..." if self._stopping else ""
            self.say(f"[WARNING] [launch]: user interrupted with ctrl-c (SIGINT){again}")
        elif signal.SIGTERM in numbers or signal.SIGHUP in numbers:
            self.say("[WARNING] [launch]: asked to end")
        if any(number in numbers for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)):
            self._stop()

    def _stop(self) -> None:
        """Begin to end all processes; what has been begun goes on."""
        self._stopping = True
        self._timers.clear()
        for child in self._children:
            if not child.ladder.climbed:
                self._climb(child)

    def _climb(self, child: LaunchedProcess) -> None:
        before = child.ladder.climbed[-1:]
        number, _ = child.ladder.climb()
        for ignored, seconds in before:
            self.say(
                f"[ERROR] [{child.label}]: process[{child.label}] failed to terminate '{seconds:g}' seconds after "
                f"receiving '{ignored.name}', escalating to '{number.name}'"
            )
        self.say(f"[INFO] [{child.label}]: sending signal '{number.name}' to process[{child.label}]")
        child.process.send(number)

    def _escalate(self) -> None:
        for child in self._children:
            if child.ladder.pause_s() == 0:
                self._climb(child)

    def _fire_timers(self) -> None:
        now = time.monotonic()
        due = [timer for timer in self._timers if timer[0] <= now]
        self._timers = [timer for timer in self._timers if timer[0] > now]
        for _, actions, context in due:
            execute_all(actions, context, self)

    def _reap(self) -> None:
        for child in [child for child in self._children if child.process.exit_code() is not None]:
            self._drain(child)
            self._children.remove(child)
            code = child.process.exit_code()
            if code == 0:
                self.say(f"[INFO] [{child.label}]: process has finished cleanly [pid {child.process.pid}]")
            else:
                self.say(
                    f"[ERROR] [{child.label}]: process has died [pid {child.process.pid}, exit code {code}, "
                    f"cmd '{child.command}']."
                )
            child.clean_up()

    def _drain(self, child: LaunchedProcess) -> None:
        """Pass on what the process has left behind; a grandchild may hold its streams open for longer."""
        for stream in child.streams:
            with contextlib.suppress(KeyError):
                self._take_output(child, stream)
                self._selector.unregister(stream)

    def _end_all(self, woken: int) -> None:
        """Whatever has happened, no process stays behind."""
        if self._children:
            self._stop()
        while self._children:
            self._wait(woken)
            self._escalate()
            self._reap()

    @contextlib.contextmanager
    def _signals(self) -> Iterator[int]:
        """Signals as bytes to be read, so that they come between two steps and never inside one."""
        woken, wake = os.pipe()
        os.set_blocking(wake, False)
        before = {number: signal.signal(number, lambda *_: None) for number in _SIGNALS}
        wakeup = signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
        self._selector.register(woken, selectors.EVENT_READ)
        try:
            yield woken
        finally:
            signal.set_wakeup_fd(wakeup)
            for number, handler in before.items():
                signal.signal(number, handler)
            self._selector.close()
            os.close(woken)
            os.close(wake)


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
