"""Runs a launch file: starts its processes, passes their output on, and sees that all of them end."""

from __future__ import annotations

import contextlib
import os
import platform
import selectors
import shlex
import signal
import sys
import time
from collections import deque
from functools import partial
from pathlib import Path
from typing import IO, TYPE_CHECKING

from course_kit import environment
from course_kit.launch import package_index
from course_kit.launch.actions import doubt_arguments
from course_kit.launch.description import OnProcessExit, ProcessExited, Shutdown, execute_all, load_description
from course_kit.launch.entity import LaunchContext
from course_kit.launch.errors import ProgramError
from course_kit.process.child import NOWHERE, PIPE, Child, Ladder, LineReader

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.launch.node import ProcessDescription

PATIENCE_S = (5.0, 5.0, 5.0)  # after SIGINT, SIGTERM and SIGKILL; the real launch's defaults
_ALWAYS_CHECK = 1.0  # seconds; a signal wakes the loop, this is for what no signal tells
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD)


class LaunchedProcess:
    """A process of a launch file."""

    def __init__(  # noqa: PLR0913 - a process is described by that much
        self,
        description: ProcessDescription,
        label: str,
        *,
        command: list[str] | None = None,
        environ: dict[str, str] | None = None,
        inherits: tuple[int, ...] | None = None,
        run: Callable[[], object] | None = None,
    ) -> None:
        self.description, self.label = description, label
        self.command = shlex.join(description.command)
        self.ladder = Ladder(*PATIENCE_S)
        show_stdout, show_stderr = description.show
        self.process = Child(
            command or description.command,
            environ=environ or description.environ,
            stdout=PIPE if inherits is None else None if show_stdout else NOWHERE,
            stderr=PIPE if inherits is None else None if show_stderr else NOWHERE,
            descriptors=inherits or (),
            dies_with_us=True,  # launch has one thread
            run=run,
        )
        self.streams: dict[IO[bytes], tuple[LineReader, bool]] = {}
        pipes = ((self.process.stdout, show_stdout), (self.process.stderr, show_stderr))
        for stream, screen in pipes:
            if stream is not None:
                self.streams[stream] = (LineReader(stream.fileno()), screen)


class LaunchService:
    """One run of a launch file, in the main thread."""

    def __init__(self, log: IO[str]) -> None:
        self._log = log
        self._children: list[LaunchedProcess] = []
        self._started = 0
        self._timers: list[tuple[float, Callable[[], object]]] = []
        self._temporary: list[Path] = []
        self._events: deque[object] = deque()
        self._handlers: list[tuple[OnProcessExit, LaunchContext]] = []
        self._selector = selectors.DefaultSelector()
        self._failed = False
        self.stopping = False

    def run(self, file: Path, arguments: dict[str, str]) -> int:
        """Run until all processes have ended and no timer is left."""
        package_index.make_known([file.parent])
        environ = environment.child_environment(PYTHONUNBUFFERED="1")
        context = LaunchContext(dict(arguments), file, environ, service=self)
        with signals_as_bytes() as woken:
            self._selector.register(woken, selectors.EVENT_READ)
            try:
                execute_all(load_description(file), context)
                for doubt in doubt_arguments(arguments, context.declared):
                    self.say(f"[WARNING] [launch]: {doubt}")
                self._handle_events()
                while self._children or (self._timers and not self.stopping):
                    self._wait(woken)
                    self._fire_timers()
                    self._escalate()
                    self._reap()
                    self._handle_events()
            finally:
                self._end_all(woken)
                self._selector.close()
        return 1 if self._failed else 0

    # What actions ask

    def start(self, description: ProcessDescription) -> None:
        """Start a process; its temporary files are removed at the end of the launch."""
        self._temporary += description.temporary
        if not self.stopping:
            self._started += 1
            label = f"{description.label}-{self._started}"
            try:
                child = self.make_child(description, label)
            except OSError as error:
                raise ProgramError(f"{description.command[0]} cannot be started: {error.strerror}.") from error
            self._children.append(child)
            for stream in child.streams:
                self._selector.register(stream, selectors.EVENT_READ, (child, stream))
            self.say(f"[INFO] [{label}]: process started with pid [{child.process.pid}]")

    def call_later(self, seconds: float, function: Callable[[], object]) -> None:
        """Call a function after a while, unless the launch ends before."""
        self._timers.append((time.monotonic() + seconds, function))

    def register(self, handler: OnProcessExit, context: LaunchContext) -> None:
        """Have an event handled from now on, with this context for what is done."""
        self._handlers.append((handler, context))

    def emit(self, event: object) -> None:
        """Have an event handled as soon as what is being done is done."""
        self._events.append(event)

    def fail(self, error: ProgramError) -> None:
        """Say that one program cannot be started, and go on without it."""
        self._failed = True
        self.say(f"[ERROR] [launch]: {error}", shown=False)
        sys.stderr.write(f"[ERROR] [launch]: {error}\n")

    def say(self, text: str, *, shown: bool = True) -> None:
        """Write a line to the log, and to the screen if it is shown."""
        self._log.write(f"{text}\n")
        self._log.flush()
        if shown:
            sys.stdout.write(f"{text}\n")
            sys.stdout.flush()

    def make_child(self, description: ProcessDescription, label: str) -> LaunchedProcess:
        return LaunchedProcess(description, label)

    # Processes

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
            child.process.kill()  # what is left of its group
            plan = child.description
            self.emit(ProcessExited(plan.action, child.label, plan.command, child.process.pid, code or 0))
            if plan.respawn_s is not None and not self.stopping:
                self.call_later(plan.respawn_s, partial(self.start, plan))

    def _drain(self, child: LaunchedProcess) -> None:
        """Pass on what the process has left behind; a grandchild may hold its streams open for longer."""
        for stream in child.streams:
            with contextlib.suppress(KeyError):
                self._take_output(child, stream)
                self._selector.unregister(stream)

    # The loop

    def _wait(self, woken: int) -> None:
        due = [max(0.0, at - time.monotonic()) for at, _ in self._timers]
        left = min([*due, *(child.ladder.pause_s() for child in self._children), _ALWAYS_CHECK])
        for key, _ in self._selector.select(left):
            if key.fd == woken:
                self._take_signals(os.read(woken, 100))
            else:
                self._take_output(*key.data)

    def _take_output(self, child: LaunchedProcess, stream: IO[bytes]) -> None:
        lines, screen = child.streams[stream]
        for line in lines.read():
            text = line.rstrip("\r")
            self.say(f"[{child.label}] {text}", shown=screen)
        if lines.ended:
            self._selector.unregister(stream)

    def _take_signals(self, numbers: bytes) -> None:
        if signal.SIGINT in numbers:
            again = " again, ignoring..." if self.stopping else ""
            self.say(f"[WARNING] [launch]: user interrupted with ctrl-c (SIGINT){again}")
        elif signal.SIGTERM in numbers or signal.SIGHUP in numbers:
            self.say("[WARNING] [launch]: asked to end")
        if any(number in numbers for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)):
            self._stop()

    def _handle_events(self) -> None:
        while self._events:
            event = self._events.popleft()
            for handler, context in [entry for entry in self._handlers if entry[0].matches(event)]:
                execute_all(handler.handle(event, context), context)
            if isinstance(event, Shutdown) and not self.stopping:
                self.say(f"[INFO] [launch]: shutting down: {event.reason}")
                self._stop()

    def _stop(self) -> None:
        """Begin to end all processes; what has been begun goes on."""
        self.stopping = True
        self._timers.clear()
        for child in self._children:
            if not child.ladder.climbed:
                self._climb(child)

    def _climb(self, child: LaunchedProcess) -> None:
        before = child.ladder.climbed[-1:]
        number, _ = child.ladder.take_signal()
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
        for _, function in due:
            function()

    def _end_all(self, woken: int) -> None:
        """Whatever has happened, no process stays behind."""
        if self._children:
            self._stop()
        while self._children:
            self._wait(woken)
            self._escalate()
            self._reap()
        for path in self._temporary:
            path.unlink(missing_ok=True)


@contextlib.contextmanager
def log_file() -> Iterator[IO[str]]:
    """The log of one launch among the logs of ROS; the first lines on the screen say where."""
    environment.apply_settings()
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
