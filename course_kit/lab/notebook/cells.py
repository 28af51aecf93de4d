"""What the lab does in a Jupyter kernel: lines land in the right cell, in order, and interrupts arrive.

ipykernel files output under the cell that runs when it is written, and differs between 6 and 7 for what threads
write. So only the main thread writes: the lab's thread queues its lines (see `output`), log lines included, which
are taken where rclpy hands them to C, before they get a timestamp and bypass Python through file descriptor 2.
"""

from __future__ import annotations

import asyncio
import builtins
import contextvars
import os
import select
import signal
import sys
import threading
import traceback
import warnings
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from course_kit.lab.awaiting import UNAWAITED
from course_kit.lab.errors import InputError, LabError
from course_kit.lab.overrides.patches import Patches
from course_kit.lab.runtime.failures import advice_on, explain_error

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

    ExceptionTuple = tuple[type[BaseException], BaseException, TracebackType | None]
    CellEnd = Callable[..., None]  # gets what names lead to, and whether the cell was `stopped` or has `failed`

    from course_kit.lab.notebook.output import Output, Stream
    from course_kit.lab.runtime.failures import Locate
    from course_kit.ros.compat import Compatibility

_BEAT = 0.1  # seconds
LINES = 2_000  # of a cell, to each stream
_STREAMS: tuple[Stream, ...] = ("stdout", "stderr")


class Notebook:
    """The connection to the IPython shell of this process, if there is one."""

    def __init__(self, output: Output) -> None:
        ipython = sys.modules.get("IPython")
        self._shell: Any = ipython.get_ipython() if ipython is not None else None
        self._output = output
        self.nodes_run: Callable[[], bool] = lambda: False
        self.on_end: CellEnd = lambda *_, **__: None
        self._stopped = False  # in this cell
        self._left = dict.fromkeys(_STREAMS, LINES)  # lines that the running cell may still print
        self._writing: set[int] = set()  # threads that are in `write`; IPython puts its tee between two of ours
        self._patches = Patches()
        self._attached = False
        self._loop: asyncio.AbstractEventLoop | None = None
        self._scheduled = False
        self._beat: asyncio.TimerHandle | None = None

    @property
    def title(self) -> str:
        """What other notebooks call this one: its file, or the program's."""
        session = os.environ.get("JPY_SESSION_NAME", "") if self.present else sys.argv[0]
        return Path(session).name or "another program"

    @property
    def present(self) -> bool:
        return self._shell is not None

    def ros_arguments(self, found: Compatibility) -> list[str]:
        """What rclpy.init is given: in a plain program its command line, which may have ROS arguments."""
        if not self.present:
            return sys.argv
        from course_kit.ros import compat

        return ["--ros-args", "--disable-stdout-logs"] if found.has(compat.LOG_LINES) else []

    def locate(self, filename: str) -> str | None:
        """The name of a cell, such as "In[3]", by the file name its code was compiled with."""
        with suppress(AttributeError):  # there may be no shell
            found = self._shell.compile.format_code_name(filename)
            return str(found[1]) if found else None
        return None

    def attach(self, thread_id: int, found: Compatibility) -> None:
        """Begin: take over what the thread prints and logs, and all further producers of output."""
        self._output.producers.add(thread_id)
        if self.present:
            from course_kit.ros import compat

            self.watch_output()
            self._patches.set(warnings, "showwarning", self._route_warnings(warnings.showwarning))
            if found.has(compat.LOG_LINES):
                self._capture_logs()
            self._show_nodes_by_name()

    def watch_output(self) -> None:
        """Queue what comes from elsewhere, and show it in the notebook's main thread."""
        if not self.present or self._attached:
            return
        self._attached = True
        self._output.queued = True
        self._output.cell = contextvars.copy_context()
        self._route()
        show_all_output(self._patches)
        self._shell.events.register("pre_run_cell", self._before_cell)
        self._shell.events.register("post_run_cell", self._after_cell)
        self._notice_stop()  # the cell that brought us here has begun
        tell_briefly(self._patches, self._shell, self.locate, self.nodes_run)
        with suppress(RuntimeError):  # a terminal has no loop; there lines wait for the end of a command
            self._loop = asyncio.get_running_loop()
            self._output.on_put = self._drain_soon
            self._keep_beating()

    def detach(self) -> None:
        if not self._attached:
            return
        self._attached = False
        for name in _STREAMS:  # one that IPython still holds passes everything through from now on
            vars(getattr(sys, name)).pop("write", None)
        self._patches.undo()
        self._output.queued = False
        self._output.on_put = lambda: None
        for event, function in (("pre_run_cell", self._before_cell), ("post_run_cell", self._after_cell)):
            with suppress(ValueError):
                self._shell.events.unregister(event, function)

    def _route(self) -> None:
        """Have the lab's thread queue what it prints, and any other show what is queued first."""
        for name in _STREAMS:
            stream = getattr(sys, name)
            if getattr(stream.write, "notebook", None) is not self:
                stream.write = self._route_writes(name, stream.write)
        if getattr(builtins.input, "notebook", None) is not self:  # ipykernel replaces it for each cell, too
            builtins.input = self._guard_input(builtins.input)

    def _route_writes(self, name: Stream, write: Callable[[str], Any]) -> Callable[[str], Any]:
        def routed(text: str) -> Any:
            thread = threading.get_ident()
            if not self._attached or thread in self._writing:
                return write(text)
            if thread in self._output.producers:
                self._output.put_part(text, name)
                return len(text)
            if threading.current_thread() is threading.main_thread():
                self._output.drain()
            if words := self._limit(text, name):
                self._writing.add(thread)
                try:
                    write(words)
                finally:
                    self._writing.discard(thread)
            return len(text)

        routed.notebook = self  # type: ignore[attr-defined] # the mark `_route` looks for
        return routed

    def _limit(self, text: str, name: Stream) -> str:
        """What is shown of a text; a node in the background prints for hours."""
        left = self._left[name]
        words = "".join(text.splitlines(keepends=True)[:left])
        self._left[name] -= words.count("\n")
        if left > 0 and self._left[name] <= 0:
            return f"{words}... This cell has printed {LINES:,} lines: the rest is left out.\n"
        return words

    def _guard_input(self, ask: Callable[..., str]) -> Callable[..., str]:
        """`input`, which no callback can wait for: the notebook shows no box to type in, and every node stands."""

        def asking(*prompt: object) -> str:
            if self._attached and threading.get_ident() in self._output.producers:
                raise InputError(
                    "input() in a callback would stop every node until somebody types. Ask in a cell, and send the "
                    "answer in a request, a goal or a parameter."
                )
            return ask(*prompt)

        asking.notebook = self  # type: ignore[attr-defined] # the mark `_route` looks for
        return asking

    def _capture_logs(self) -> None:
        from rclpy.impl import rcutils_logger
        from rclpy.logging import LoggingSeverity

        original = rcutils_logger._rclpy  # noqa: SLF001 - the C module, by which log lines are handed over

        def log(severity: Any, name: str, message: str, *caller: Any) -> None:
            """Queue the line, and pass it on for /rosout and the log file."""
            self._output.put(f"[{LoggingSeverity(severity).name}] [{name}]: {message}\n")
            if threading.current_thread() is threading.main_thread():
                self._output.drain()
            original.rclpy_logging_rcutils_log(severity, name, message, *caller)

        stand_in = SimpleNamespace(**{**vars(original), "rclpy_logging_rcutils_log": log})
        self._patches.set(rcutils_logger, "_rclpy", stand_in)

    def _route_warnings(self, show: Callable[..., None]) -> Callable[..., None]:
        """Warnings of rclpy without the place in rclpy, which is not where the learner went wrong."""

        def warned(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
            if "Failed to fini " in str(message):  # beside the error that says why
                return
            if threading.get_ident() in self._output.producers or "rclpy" in str(place[:1]):
                self._output.put(f"{category.__name__}: {message}\n", "stderr")
            else:
                show(message, category, *place, **more)

        return warned

    def _show_nodes_by_name(self) -> None:
        """Let a cell that ends with `lab.start(...)` show the node's name, not its address in memory."""
        from rclpy.node import Node

        from course_kit.lab.runtime.describe import describe_node, is_alive

        def show(node: Any, printer: Any, _cycle: bool) -> None:
            kind = type(node).__name__
            printer.text(describe_node(node) if is_alive(node) else f"{kind} (stopped)")
            if is_alive(node) and node.executor is None:
                printer.text(f"\nNobody runs this node. lab.start({kind}) makes one and runs it.")

        formatter = self._shell.display_formatter.formatters["text/plain"]
        formatter.for_type(Node, show)

    def _drain_soon(self) -> None:
        loop = self._loop
        if loop is None or self._scheduled or threading.current_thread() is threading.main_thread():
            return
        self._scheduled = True
        with suppress(RuntimeError):  # the loop is closed: the kernel is ending
            loop.call_soon_threadsafe(self._drain_now)

    def _drain_now(self) -> None:
        self._scheduled = False
        self._output.drain()

    def _before_cell(self, _info: object) -> None:
        self._output.cell = contextvars.copy_context()
        self._left = dict.fromkeys(_STREAMS, LINES)
        self._route()
        self._keep_beating()
        self._notice_stop()

    def _after_cell(self, result: object) -> None:
        if self._beat is not None:
            self._beat.cancel()
            self._beat = None
        self._output.end_parts()
        self._output.drain()
        failed = getattr(result, "error_in_exec", None) is not None
        self.on_end(list(self._shell.user_ns.values()), stopped=self._stopped, failed=failed)
        self._output.drain()
        self._tell_not_awaited()
        tell_meaning(result, self.locate)
        if self._loop is not None:
            self._loop.call_soon(self._route)

    def _tell_not_awaited(self) -> None:
        """The cell has ended: say which verbs nothing has awaited, nor will."""
        verbs = list(UNAWAITED)
        UNAWAITED.clear()
        coming: list[Any] = []
        with suppress(RuntimeError):  # a terminal has no loop
            coming = [task.get_coro() for task in asyncio.all_tasks()]
        missing = [verb for verb in verbs if not any(other is verb for other in coming)]
        for sentence in dict.fromkeys(map(repr, missing)):
            sys.stderr.write(f"{sentence}\n")

    def _notice_stop(self) -> None:
        """A cell begins; ipykernel puts back what was there before it."""
        self._stopped = False
        before = signal.getsignal(signal.SIGINT)
        if threading.current_thread() is not threading.main_thread() or not callable(before):
            return

        def press(number: int, frame: FrameType | None) -> None:
            self._stopped = True
            before(number, frame)

        press.of_the_lab = True  # type: ignore[attr-defined] # a terminal keeps it from one command to the next
        if not hasattr(before, "of_the_lab"):
            signal.signal(signal.SIGINT, press)

    def _keep_beating(self) -> None:
        if self._loop is not None:
            if self._beat is not None:
                self._beat.cancel()
            self._beat = self._loop.call_later(_BEAT, self._keep_beating)


def tell_meaning(result: Any, locate: Locate) -> None:
    """Say what a cell's error means, where Python's or rclpy's words do not."""
    error = getattr(result, "error_in_exec", None)
    if not isinstance(error, BaseException) or isinstance(error, LabError) or explain_error(error, locate):
        return
    if meant := advice_on(error):
        sys.stderr.write(f"{meant}\n")


def show_all_output(patches: Patches) -> None:
    """Have pexpect look for output once more when a program has ended."""
    try:
        from pexpect import EOF, spawn
    except ImportError:  # IPython needs it only where there are pseudoterminals
        return
    read = spawn.read_nonblocking

    def read_to_the_end(program: Any, size: int = 1, timeout: float | None = -1) -> Any:
        try:
            return read(program, size, timeout)
        except EOF:
            if not select.select([program.child_fd], [], [], 0)[0]:
                raise
            return super(spawn, program).read_nonblocking(size)

    patches.set(spawn, "read_nonblocking", read_to_the_end)


_INTERRUPTS = (KeyboardInterrupt, asyncio.CancelledError)


class _BriefError(Exception):
    """Shown in place of an error whose traceback says less than a sentence."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


def tell_briefly(patches: Patches, shell: Any, locate: Locate, nodes_run: Callable[[], bool]) -> None:
    """Have an interrupted cell say where it was and that nodes go on; and what ROS refuses be one sentence."""
    show = shell.showtraceback

    def tell(exc_tuple: ExceptionTuple | None = None, *place: Any, **more: Any) -> None:
        kind, error, trace = exc_tuple or sys.exc_info()
        if kind is None or error is None or not issubclass(kind, _INTERRUPTS):
            if error is not None and not isinstance(error, LabError) and (text := explain_error(error, locate)):
                show((kind, _BriefError(text), trace))
            else:
                show(exc_tuple, *place, **more)
            return
        places = [
            f"{name}, line {number}"
            for frame, number in traceback.walk_tb(trace)
            if (name := locate(frame.f_code.co_filename))
        ]
        where = places[-1] if places else f"In[{shell.execution_count}]"
        rest = "; your nodes go on." if nodes_run() else "."
        show((kind, _BriefError(f"Interrupted in {where}{rest}"), trace))

    patches.set(shell, "showtraceback", tell)
