"""Programs as child processes: started, streamed, waited for when they end by themselves, and stopped.

All of them write into one pipe, and report what crosses through another. The kernel keeps the order of what is
written into a pipe; so lines appear in the order in which the processes wrote them, whoever wrote them.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import select
import sys
import threading
import time
from typing import TYPE_CHECKING, Literal, cast, get_args

from course_kit import environment
from course_kit.lab.errors import ScriptError
from course_kit.lab.recording.events import KINDS, Event
from course_kit.process.child import Child, Ladder, LineReader
from course_kit.process.libc import make_memory_file
from course_kit.reader.text import as_utf8

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.notebook.output import Output


class Script:
    """A running program."""

    def __init__(self, name: str, process: Child) -> None:
        self.name = name
        self.process = process
        self.nodes: list[str] = []
        self.spins = ""
        self.last_line = ""  # of the traceback with which it answered Ctrl-C
        self.stopping = False
        self.follower: threading.Thread | None = None

    @property
    def running(self) -> bool:
        return self.process.exit_code() is None

    def __repr__(self) -> str:
        code = self.process.exit_code()
        if code is None:
            return f"{self.name} is running."
        return f"{self.name} has ended." if code == 0 or self.stopping else f"{self.name} ended with exit code {code}."


def checked_name(name: str) -> str:
    """The name without ".py"; raises ScriptError for one that cannot be a file's."""
    bare = name.removesuffix(".py")
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", bare):
        raise ScriptError(f"{name!r} cannot name a script: use letters, digits and underscores, such as server.")
    return bare


Mode = Literal["auto", "wait", "background"]
LOG_FORMAT = "[{severity}] [{name}]: {message}"
_RUNNER = "course_kit.lab.scripts.child_main"
_UP = 10.0  # seconds until a program that neither ends nor spins is left to itself
_CLIENT = 60.0  # the same for one that has asked something
_WAIT = 600.0  # the same in mode "wait"
_GRACE = (2.0, 1.0, 1.0)  # seconds for SIGINT, SIGTERM, SIGKILL
_TURN = 0.1


class Scripts:
    """The programs of one lab."""

    def __init__(self, output: Output, forward: Callable[[Event], None], mark: str) -> None:
        self.wait_for_nodes: Callable[[list[str], bool], None] = lambda *_: None  # until they are there, or are not
        self._off: set[str] = set()  # what this rclpy does not let us watch
        self._output, self._forward, self._mark = output, forward, mark
        self._running: dict[str, Script] = {}
        self._lock = threading.Lock()
        (text, self._text_end), (reports, self._reports_end) = os.pipe(), os.pipe()
        self._pipes = (text, self._text_end, reports, self._reports_end)
        self._text, self._reports = LineReader(text), LineReader(reports)
        self._closing = threading.Event()
        self._output.pumps.append(self.pump)
        self._reader = threading.Thread(target=self._read, name="ros-scripts", daemon=True)
        self._reader.start()

    def run(self, name: str, source: str, arguments: tuple[str, ...], mode: str, runner: str = _RUNNER) -> Script:
        """Start a program in place of the one of this name; returns as `mode` says."""
        name = checked_name(name)
        if mode not in get_args(Mode):
            raise ScriptError(f"The mode is one of {', '.join(get_args(Mode))}, not {mode!r}.")
        if before := self._running.get(name):
            self._terminate(before)
        script = self._start(name, source, arguments, runner)
        try:
            self._wait(script, cast("Mode", mode))
        except KeyboardInterrupt:
            self._terminate(script)
            self._say(f"{name} was interrupted.")
        self._output.drain()
        return script

    def stop(self, name: str | None, *, as_in_terminal: bool = False) -> None:
        """End one program, or all, and say so; on request with what a terminal shows of it."""
        running = dict(sorted(self._running.items()))
        if name is not None and (name := checked_name(name)) not in running:
            raise ScriptError(f"No script called {name!r} is running. Running: {', '.join(running) or 'none'}.")
        for script in running.values() if name is None else [running[name]]:
            self._terminate(script)
            self._say(f"{script.name} is stopped.")
            if as_in_terminal:
                code = 1 if script.last_line else script.process.exit_code()
                last = f" Its last line is: {script.last_line}" if script.last_line else ""
                self._say(f"In a terminal, Ctrl-C ends it with exit code {code}.{last}")
        self._output.drain()

    def nodes(self) -> dict[str, str]:
        """The full names of the programs' nodes, each with the program's name."""
        return {node: script.name for script in list(self._running.values()) for node in script.nodes}

    def close(self) -> None:
        for script in list(self._running.values()):
            self._terminate(script)
        self._closing.set()
        os.write(self._reports_end, b"\n")  # wakes the reader
        self._reader.join(_GRACE[0])
        self.pump()
        self._output.pumps.remove(self.pump)
        for descriptor in self._pipes:
            os.close(descriptor)

    def pump(self) -> None:
        """Take in what has been written so far, without waiting for more."""
        with self._lock:
            for line in self._reports.read():
                self._take_report(line)
            for line in self._text.read():
                self._say(line)

    def _start(self, name: str, source: str, arguments: tuple[str, ...], runner: str) -> Script:
        path = environment.run_dir(environment.paths.CELL_PROGRAMS) / f"{name}.py"
        saved = as_utf8(source).encode()
        path.write_bytes(saved)
        command = [sys.executable, "-m", runner, name, str(os.getpid()), str(self._reports_end)]
        # Another notebook can save a program of the same name before this one is read.
        with open(make_memory_file(name), "w+b", buffering=0) as text:  # noqa: PTH123 - a descriptor
            text.write(saved)
            process = Child(
                [*command, str(path), *arguments],
                stdout=self._text_end,
                stderr=self._text_end,
                descriptors=(self._reports_end, text.fileno()),
                environ=environment.child_environment(
                    RCUTILS_CONSOLE_OUTPUT_FORMAT=LOG_FORMAT,
                    RCUTILS_COLORIZED_OUTPUT="0",
                    PYTHON_COLORS="0",  # kernels set FORCE_COLOR, and Python 3.13 would colour what it complains of
                    COURSE_KIT_LAB_MARK=self._mark,
                    COURSE_KIT_PROGRAM_TEXT=str(text.fileno()) if runner == _RUNNER else None,
                    PYTHONIOENCODING="utf-8",  # as it is read here, whatever the locale
                ),
            )
        script = Script(name, process)
        self._running[name] = script
        script.follower = threading.Thread(target=self._follow, args=(script,), name=f"ros-script-{name}", daemon=True)
        script.follower.start()
        return script

    def _follow(self, script: Script) -> None:
        """Wait for a program's end, on its own thread; tell of one that ended in the background."""
        code = script.process.wait()
        self.pump()
        if self._running.get(script.name) is script:
            del self._running[script.name]
        if not self._running:
            self._end_line()
        if code not in {0, 1} and not script.stopping:  # 1 has just shown its traceback
            self._say(f"{script.name} ended with exit code {code}.")
        self._output.poke()

    def _wait(self, script: Script, mode: Mode) -> None:
        begun = time.monotonic()
        while script.running:
            if mode != "wait" and script.spins and (script.spins == "server" or mode == "background"):
                self.wait_for_nodes(script.nodes, True)
                names = ", ".join(node[1:] if node.count("/") == 1 else node for node in script.nodes)
                self.pump()  # what it has printed before it began to spin comes first
                self._say(f"{script.name} is running in the background" + (f" (node {names})." if names else "."))
                return
            limit = _WAIT if mode == "wait" else _CLIENT if script.spins == "client" else _UP
            if time.monotonic() - begun > limit:
                self._say(
                    f"{script.name} has not ended within {limit:.0f} s and goes on in the background; "
                    f"%ros_stop {script.name} ends it."
                )
                return
            self._output.wait(_TURN)
            self._output.drain()
        if script.follower is not None:
            script.follower.join(_GRACE[0])  # it has taken in the last lines then

    def _terminate(self, script: Script) -> None:
        script.stopping = True
        script.process.end(Ladder(*_GRACE))
        self.pump()
        self._running.pop(script.name, None)
        self.wait_for_nodes(script.nodes, False)

    def _say(self, text: str) -> None:
        self._output.put(text + "\n")

    def _read(self) -> None:
        poll = select.poll()
        for descriptor in (self._pipes[0], self._pipes[2]):
            poll.register(descriptor, select.POLLIN)
        while not self._closing.is_set():
            poll.poll()
            self.pump()

    def _end_line(self) -> None:
        """Show what has no line end and, now that nobody is left to write it, will get none."""
        with self._lock:
            for line in self._text.take_rest():
                self._say(line)

    def _take_report(self, line: str) -> None:
        try:
            report = json.loads(line)
            script = self._running.get(report["script"])
        except (ValueError, KeyError, TypeError):  # the program has written into our pipe
            return
        if script is not None and "node" in report and "event" not in report:
            script.nodes.append(str(report["node"]))
        elif script is not None and "spins" in report:
            script.spins = str(report["spins"])
            self._output.poke()
        elif script is not None and "last_line" in report:
            script.last_line = str(report["last_line"]).partition(", at ")[0]  # a line of ROS's own C code
        elif script is not None and "off" in report and report["off"] not in self._off:
            self._off.add(report["off"])
            self._output.put(f"{report['off']}\n", "stderr")
        elif report.get("event") in KINDS:
            with contextlib.suppress(KeyError):
                self._forward(Event(report["event"], *(report[name] for name in Event._fields[1:])))
