"""Runs an unmodified ROS 2 program as a child of the kernel.

`python -m course_kit.lab.scripts.child_main NAME PARENT_PID DESCRIPTOR FILE [arguments]`, where
COURSE_KIT_PROGRAM_TEXT is the descriptor of a file with the program's text, if FILE can have changed.

The process ends when the kernel dies; what crosses between nodes is reported over a pipe, as JSON lines.
"""

from __future__ import annotations

import contextlib
import io
import json
import linecache
import os
import runpy
import select
import signal
import sys
import threading
import traceback
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from course_kit.lab.recording.events import EventStream
from course_kit.process.libc import die_with_parent

if TYPE_CHECKING:
    from types import FrameType

    from rclpy.node import Node

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.recording.events import Event

_ATOMIC = 4000  # bytes; pipe(7) writes up to PIPE_BUF, 4096, in one piece
INTERRUPTED = 130


class Reports:
    """The way back to the kernel."""

    def __init__(self, script: str, descriptor: int) -> None:
        self._script = script
        self._descriptor = descriptor

    def send(self, **report: object) -> None:
        """Send one line; one that the pipe could not take in one piece loses its value."""
        line = json.dumps({"script": self._script, **report}, default=str)
        if len(line) > _ATOMIC:
            line = json.dumps({"script": self._script, **report, "value": "..."}, default=str)
        with contextlib.suppress(OSError):  # the kernel has gone
            os.write(self._descriptor, line.encode() + b"\n")

    def event(self, event: Event) -> None:
        self.send(event=event.kind, **{name: value for name, value in event._asdict().items() if name != "kind"})


class _Interrupts:
    """SIGINT as KeyboardInterrupt, remembered: what an interrupted program says about it is no news."""

    def __init__(self) -> None:
        self.seen = False
        signal.signal(signal.SIGINT, self._handle)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        del number, frame
        self.seen = True
        raise KeyboardInterrupt


def report(reports: Reports) -> None:
    """Have rclpy report from now on."""
    from rclpy.executors import Executor
    from rclpy.node import Node

    from course_kit.lab.overrides.patches import Patches, quieten_finalizers
    from course_kit.lab.runtime.neighbours import MARK_VARIABLE, mark_as

    mark = os.environ.pop(MARK_VARIABLE, "")
    patches = Patches()
    quieten_finalizers(patches)
    _record(patches, reports)
    initialise = Node.__init__
    wait = Executor.wait_for_ready_callbacks

    def initialise_seen(node: Node, *arguments: Any, **options: Any) -> None:
        nonlocal mark
        initialise(node, *arguments, **options)
        if mark:
            mark_as(mark, node)
            mark = ""
        reports.send(node=node.get_fully_qualified_name())

    reported = ""

    def waiting(executor: Executor, *arguments: Any, **options: Any) -> Any:
        nonlocal reported
        role = _role(executor.get_nodes())
        if role != reported:
            reported = role
            reports.send(spins=role)
        if role == "server":  # that is final, while a client may become one
            setattr(Executor, "wait_for_ready_callbacks", wait)  # noqa: B010 - mypy forbids to assign to a method
        return wait(executor, *arguments, **options)

    patches.set(Node, "__init__", initialise_seen)
    patches.set(Executor, "wait_for_ready_callbacks", waiting)


def _record(patches: Patches, reports: Reports) -> None:
    """Have what crosses reported, as far as this rclpy lets itself be watched."""
    from rclpy.executors import Executor

    from course_kit.lab.recording.hooks import MessageHooks
    from course_kit.ros import compat

    events = EventStream()
    events.listen(reports.event)
    hooks = MessageHooks(events)
    found = compat.check_features(compat.OF_SCRIPTS)
    for sentence in found.sentences():
        reports.send(off=sentence)
    if found.has(compat.GOAL_RECORDING):
        from course_kit.lab.recording.action_hooks import ActionHooks

        ActionHooks(hooks, patches)
    if found.has(compat.EXECUTIONS):
        from course_kit.lab.recording.action_hooks import hook_execution

        hook_execution(patches, hooks)
    if found.has(compat.RECORDING):
        hooks.hook_sending(patches)
        hooks.hook_taking(patches, Executor)


def _role(nodes: list[Node]) -> str:
    """Whether these nodes wait for others ("server") or only for answers to what they have asked ("client")."""
    from rclpy.action import ActionClient, ActionServer

    from course_kit.ros.names import is_of_every_node

    waits = asks = False
    for node in nodes:
        waits |= any(not is_of_every_node(service.service_name) for service in node.services)
        waits |= any(True for _ in node.timers) or any(True for _ in node.subscriptions)
        waits |= any(isinstance(waitable, ActionServer) for waitable in node.waitables)
        asks |= any(True for _ in node.clients)
        asks |= any(isinstance(waitable, ActionClient) for waitable in node.waitables)
    return "server" if waits or not asks else "client"


def run(path: str, arguments: list[str], interrupts: _Interrupts, reports: Reports) -> int:
    """Run the program."""
    sys.argv = [path, *arguments]
    sys.path[0] = os.getcwd()  # noqa: PTH109 - sys.path takes strings
    threading.excepthook = lambda failure: _report_thread(failure, path)
    try:
        if text := os.environ.pop("COURSE_KIT_PROGRAM_TEXT", ""):
            _run_text(path, Path(f"/proc/self/fd/{text}").read_text(encoding="utf-8"))
        else:
            runpy.run_path(path, run_name="__main__")
    except SystemExit:
        raise
    except KeyboardInterrupt:
        return INTERRUPTED
    except BaseException as error:  # noqa: BLE001 - whatever a program can end with
        if interrupts.seen or type(error).__name__ == "ExternalShutdownException":
            reports.send(last_line=own_traceback(error, path).splitlines()[-1])
            return INTERRUPTED
        sys.stdout.flush()
        from course_kit.lab.runtime.failures import of_newer_ros

        newer = of_newer_ros(error)
        sys.stderr.write(own_traceback(error, path) + (f"{newer}\n" if newer else ""))
        return 1
    return 0


def _run_text(path: str, text: str) -> None:
    """Run a program's text, as `runpy` runs its file."""
    linecache.cache[path] = (len(text), None, text.splitlines(keepends=True), path)  # for tracebacks
    sys.modules["__main__"] = main_module = ModuleType("__main__")
    main_module.__file__ = path
    exec(compile(text, path, "exec"), main_module.__dict__)  # noqa: S102 - that is what it is for


def _report_thread(failure: threading.ExceptHookArgs, path: str) -> None:
    if failure.exc_value is None or isinstance(failure.exc_value, SystemExit):
        return
    name = failure.thread.name if failure.thread is not None else "?"
    sys.stderr.write(f"Exception in thread {name}:\n{own_traceback(failure.exc_value, path)}")


def own_traceback(error: BaseException, path: str) -> str:
    """The traceback with the lines of the program itself, under its plain name."""
    report = traceback.TracebackException.from_exception(error)
    part: traceback.TracebackException | None = report
    while part is not None:
        own = [frame for frame in part.stack if frame.filename == path]
        without_columns = [traceback.FrameSummary(path, frame.lineno, frame.name, line=frame.line) for frame in own]
        part.stack = traceback.StackSummary.from_list(without_columns)
        part = part.__cause__ or part.__context__
    text = "".join(report.format(chain=True)).replace(path, Path(path).name)
    # To rclpy it is a TypeError without a text; ours has one, and a name that says nothing to a learner.
    return text.replace("course_kit.lab.recording.hooks.WrongResponseError", "TypeError")


def _end_with_kernel(descriptor: int) -> None:
    """Once nobody reads its reports, a program that SIGTERM has not ended in 3 s is ended."""
    reader = select.poll()
    reader.register(descriptor, 0)  # errors come in any case
    reader.poll()
    threading.Event().wait(3.0)
    os.kill(os.getpid(), signal.SIGKILL)


def main() -> int:
    """Become the program given on the command line."""
    name, parent, descriptor, path, *arguments = sys.argv[1:]
    die_with_parent(int(parent), signal.SIGTERM)
    interrupts = _Interrupts()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(line_buffering=True, write_through=False)  # a line goes out in one piece
    os.set_inheritable(int(descriptor), False)
    reports = Reports(name, int(descriptor))
    threading.Thread(target=_end_with_kernel, args=(int(descriptor),), daemon=True).start()
    report(reports)
    return run(path, arguments, interrupts, reports)


if __name__ == "__main__":
    sys.exit(main())
