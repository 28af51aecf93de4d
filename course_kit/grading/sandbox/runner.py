"""Runs the learner's program, inside the sandbox, the way Python or `ros2 run` would.

A program with `main()`, or one that spins at its top level, is run as the script it is. A module that only defines its
Node class has that class started on a MultiThreadedExecutor. What this process notes for the grader, beside what stands
on the ROS graph, are hints for the diagnosis and never points.
"""

from __future__ import annotations

import atexit
import builtins
import faulthandler
import fcntl
import gc
import json
import os
import signal
import sys
import tempfile
import threading
import traceback
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from course_kit.grading.model import limits
from course_kit.grading.sandbox import file_view, namespaces, seccomp
from course_kit.grading.sandbox.file_view import FileView
from course_kit.grading.sandbox.start_order import Program
from course_kit.launch import actions, finder, modules  # noqa: F401 - loaded before the kit's own files disappear
from course_kit.launch.errors import LaunchError
from course_kit.launch.service import LaunchedProcess, LaunchService
from course_kit.process.libc import die_with_parent, set_name

if TYPE_CHECKING:
    from types import CodeType

    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.sandbox.start_order import StartOrder, Streams
    from course_kit.launch.node import ProcessDescription

# Ignored unless handled: harmless to a program that has replaced itself by another (exec).
STACKS_SIGNAL = signal.SIGURG
_THREADS = 4
_TURN_S = 0.1
_FIRST_HIGH_DESCRIPTOR = 200
_LONGEST_VALUE = 48 * 1024  # characters of all together; the grader keeps 64 kB of a program's notes
_LONGEST_NAME, _MOST_NAMES = 40, 50
_OURS = Path(__file__).parent
# Where rclpy holds what a callback has returned: by function, the name of our note and that of its variable.
_RETURNED = {"send_response": ("returned", "response"), "_execute_goal": ("result", "execute_result")}


def main(order: StartOrder, inside: Streams) -> None:
    """Turn this process into the submission; never returns but where it cannot be locked in."""
    try:
        evidence = _lock_in(order, inside)
        program = _prepare(order)
    except Exception as problem:  # noqa: BLE001 - all of it is the kit's; it worked when it was tried out
        inside.tell(problem=f"the program could not be started: {problem}")
        return
    os.close(inside.status)
    if program.command:
        _execute(program)
    gc.enable()
    builtins.input = _refuse_input
    faulthandler.register(STACKS_SIGNAL, file=evidence, all_threads=True)
    _run_to_end(program, evidence)


def _run_to_end(program: Program, evidence: int) -> None:
    """Run it as a script, or launch it, and end this process as Python would end."""
    status = 1
    try:
        (_launch if program.launches else _run)(program, evidence)
        status = 0
    except SystemExit as wish:
        status = _exit_status(wish.code)
        called = (frame.f_code.co_name for frame, _ in traceback.walk_tb(wish.__traceback__))
        _send_note(evidence, exit_in_callback="await_or_execute" in called)
    except BaseException as problem:  # noqa: BLE001 - whatever it is ends the program and is shown, as Python does
        _print_exception(problem)
        _note_refused_return(problem, evidence)
    _finish(status)


def _lock_in(order: StartOrder, inside: Streams) -> int:
    """Give up every right and every stream that is not the program's; returns the descriptor for evidence."""
    set_name("submission")
    os.setsid()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # as in any fresh Python; the grader's processes ignore it
    atexit._clear()  # noqa: SLF001 - what the launcher has registered is not the program's
    _give_up_rights(order)
    order.view = FileView()  # who looks through the frames below learns no name of a folder that is hidden
    return _arrange_streams(inside)


def _give_up_rights(order: StartOrder) -> None:
    """For good: after this the process, and all it starts, can do no more than the submission may."""
    if not order.isolation.files and order.isolation.landlock:
        file_view.restrict(order.view, (order.scratch, "/dev/null", "/dev/shm"))  # noqa: S108
    if order.user:
        namespaces.become(order.user)
    namespaces.drop_privileges()
    namespaces.allow_tracing()  # what it starts may look into /proc/self, as everywhere
    if order.isolation.syscalls:
        seccomp.install(processes=order.isolation.processes, files=order.isolation.files)
    for name in list(sys.modules):  # modules that are not for programs are as unknown as their files are
        if name.startswith("course_kit.") and name.split(".")[1] not in file_view.MODULES_OF_KIT:
            del sys.modules[name]


def _prepare(order: StartOrder) -> Program:
    """Lay out all that the program finds when it begins; returns it with the names of its files among its arguments."""
    program, folder = order.program, order.scratch
    os.environ.update(order.environment, HOME=folder, TMPDIR=folder, PWD=folder, ROS_LOG_DIR=f"{folder}/log")
    sys.dont_write_bytecode = True
    tempfile.tempdir = None  # the grader's own choice; TMPDIR counts now
    os.chdir(program.folder or folder)
    for name, text in program.files.items():
        Path(folder, name).write_text(text, encoding="utf-8")
    if not program.command:
        Path(program.name).write_text(program.source, encoding="utf-8", errors="surrogatepass")
    limits.apply_to_this_process(order.limits, order.others)
    named = (f"{folder}/{word}" if word in program.files else word for word in program.arguments)
    return replace(program, arguments=tuple(named))


def _arrange_streams(inside: Streams) -> int:
    """Standard streams to the pipes, every other descriptor closed but the one returned and that of the status."""
    evidence, inside.status = (
        fcntl.fcntl(pipe, fcntl.F_DUPFD_CLOEXEC, _FIRST_HIGH_DESCRIPTOR) for pipe in (inside.evidence, inside.status)
    )
    nothing = os.open(os.devnull, os.O_RDONLY)
    for source, target in ((nothing, 0), (inside.stdout, 1), (inside.stderr, 2)):
        os.dup2(source, target)
    os.closerange(3, evidence)
    os.closerange(inside.status + 1, os.sysconf("SC_OPEN_MAX"))
    for descriptor, name in enumerate(("stdin", "stdout", "stderr")):
        mode = "w" if descriptor else "r"
        stream = open(descriptor, mode, 1, "utf-8", "backslashreplace", closefd=False)  # noqa: SIM115 - it stays open
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)
    return evidence


def _refuse_input(*_: object) -> str:
    """Stands in for `input`, which would find the end of an empty file and say no more than that."""
    raise EOFError("no one is there to type an answer")


def _execute(program: Program) -> None:
    try:
        os.execvpe(program.command[0], [*program.command, *program.arguments], os.environ)
    except OSError as problem:
        sys.stderr.write(f"{program.command[0]}: {problem.strerror}\n")
        sys.stderr.flush()
        os._exit(127)


def _run(program: Program, evidence: int) -> None:
    path = Path.cwd() / program.name
    sys.argv = [program.name, *program.arguments]
    sys.path.insert(0, str(path.parent))
    module = ModuleType("__main__")
    module.__file__ = str(path)
    sys.modules["__main__"] = module
    threading.excepthook = lambda problem: _note_thread_failure(problem, evidence)
    code = compile(program.source, program.name, "exec", dont_inherit=True)
    if program.variable:
        _run_for_value(code, module, program.variable, evidence)
        return
    _watch_lost_nodes(evidence, program.name)
    from rclpy.utilities import get_default_context

    default = get_default_context()  # rclpy forgets one that was shut down, and with it that there was a node
    exec(code, module.__dict__)  # noqa: S102
    if _has_made_nodes():
        return
    del default
    node_class = _find_class(module, program, evidence)
    if node_class is not None:
        _spin(node_class)


def _launch(program: Program, evidence: int) -> None:
    """Run a launch file until all that it has started has ended."""

    class Launch(LaunchService):
        """Starts the submission's programs as forks of this process, in which all is loaded; others as ever."""

        def make_child(self, description: ProcessDescription, label: str) -> LaunchedProcess:
            python, *words = *description.command, ""
            path = Path.cwd() / words[0]
            if python != sys.executable or path.suffix != ".py" or path.parent != Path.cwd() or not path.is_file():
                return LaunchedProcess(description, label, inherits=())
            source = path.read_text(encoding="utf-8", errors="surrogatepass")
            started = Program(path.name, source, own_start=True, arguments=tuple(words[1:-1]))
            run = partial(_run_launched, started, description.environ, evidence)
            return LaunchedProcess(description, label, inherits=(), run=run)

    finder.install_finder()
    sys.meta_path.sort(key=lambda hook: not isinstance(hook, finder.LaunchFinder))  # the same launch on every machine
    try:
        with open(os.devnull, "w", encoding="utf-8") as log:  # noqa: PTH123 - a name of the kernel
            code = Launch(log).run(Path.cwd() / program.name, dict(word.split(":=") for word in program.arguments))
    except LaunchError as problem:
        raise SystemExit(f"[ERROR] [launch]: {problem}") from None
    raise SystemExit(code)


def _run_launched(program: Program, environ: Mapping[str, str], evidence: int) -> None:
    """Run a program in a fork of its launch, which waits until what the fork has inherited is closed."""
    os.closerange(3, evidence)
    gc.enable()
    set_name(program.name)
    die_with_parent()
    signal.set_wakeup_fd(-1)
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD):
        signal.signal(number, signal.SIG_DFL)
    for number in (signal.SIGPIPE, signal.SIGXFSZ):  # as Python begins
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.clear()
    os.environ.update(environ)
    _run_to_end(program, evidence)


def _run_for_value(code: CodeType, module: ModuleType, variable: str, evidence: int) -> None:
    """Run a program and hand over what it has set, as text: outside it is read as a literal and never run."""
    try:
        exec(code, module.__dict__)  # noqa: S102 - the learner's program, which is what this process is for
    except SystemExit:  # a program that ends itself has set what it wanted to set
        _send_note(evidence, **_describe_value(vars(module), variable), ended_itself=True)
        raise
    _send_note(evidence, **_describe_value(vars(module), variable))


def _describe_value(names: Mapping[str, object], variable: str) -> Record:
    """What a program has set, as texts."""
    own = [str(name)[:_LONGEST_NAME] for name in names if not str(name).startswith("_")]
    record: Record = {"set_names": own[:_MOST_NAMES]}
    if variable not in names:
        return record
    value = names[variable]
    if isinstance(value, Mapping):
        record["entries"] = [[_literal(key), _literal(entry)] for key, entry in value.items()]
    else:
        record["value"] = _literal(value)
    return record if len(json.dumps(record)) < _LONGEST_VALUE else {"set_names": record["set_names"], "too_large": True}


def _literal(value: object) -> str:
    """The value as a literal where it is one at heart: a named tuple is a tuple, a member of a text Enum a text."""
    try:
        if isinstance(value, str):
            return repr(str.__str__(value))
        if isinstance(value, (tuple, list)):
            return f"[{', '.join(_literal(part) for part in value)}]"
        return repr(value)
    except Exception:  # noqa: BLE001 - a learner's class, a list within itself, a number with too many digits
        return f"<{type(value).__name__}>"


def _has_made_nodes() -> bool:
    """Whether the program has used ROS by itself: a node, or a context that was once initialised."""
    from rclpy.context import Context
    from rclpy.node import Node

    for thing in gc.get_objects():
        kind = type(thing)  # not isinstance(): a proxy among the learner's objects may answer in its own way
        if issubclass(kind, Node):
            return True
        if issubclass(kind, Context) and thing.handle is not None and not thing.ok():
            return True
    return False


def _find_class(module: ModuleType, program: Program, evidence: int) -> type | None:
    """The class to start, or None with notes on what exists."""
    from rclpy.node import Node

    classes = {name: thing for name, thing in vars(module).items() if isinstance(thing, type)}
    classes = {name: thing for name, thing in classes.items() if thing.__module__ == "__main__"}
    own = {thing for thing in classes.values() if issubclass(thing, Node)}
    named = [thing for thing in own if thing.__name__ == program.class_name]
    if not program.own_start and (named or len(own) == 1):
        return (named or list(own))[0]
    functions = [name for name, thing in vars(module).items() if callable(thing) and not isinstance(thing, type)]
    nodes = sorted(thing.__name__ for thing in own)
    _send_note(evidence, node_classes=nodes, classes=list(classes), functions=functions)
    return None


def _spin(node_class: type) -> None:
    import rclpy
    from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

    class Executor(MultiThreadedExecutor):
        """Ends with a callback's exception at once; a callback may spin its node, as below `rclpy.spin()`."""

        turned = threading.Event()

        def wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Any:
            found: tuple[Any, Any, Any] = super().wait_for_ready_callbacks(*args, **kwargs)
            task, entity, _ = found
            self.turned.set()
            if entity is not None:  # a callback; what follows is a task itself and must not be followed again
                task.add_done_callback(lambda _: self.turned.set())  # its own event: the executor wakes, and looks
            return found

        def spin_once(self, timeout_sec: float | None = None) -> None:
            if threading.current_thread() is threading.main_thread():
                super().spin_once(timeout_sec)
            else:
                self.turned.clear()
                self.turned.wait(None if timeout_sec is None or timeout_sec < 0 else timeout_sec)

        def spin_once_until_future_complete(self, future: Any, timeout_sec: Any = None) -> None:
            future.add_done_callback(lambda _: self.turned.set())
            self.turned.clear()
            seconds = timeout_sec if isinstance(timeout_sec, (int, float)) and timeout_sec >= 0 else _TURN_S
            if not future.done():
                self.turned.wait(min(seconds, _TURN_S))

    if not rclpy.ok():
        rclpy.init(args=sys.argv)
    executor = Executor(num_threads=max(_THREADS, len(os.sched_getaffinity(0))))
    rclpy.get_global_executor = lambda: executor
    executor.add_node(node_class())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        return


def _exit_status(code: object) -> int:
    if code is None:
        return 0
    if isinstance(code, int):
        return code & 0xFF
    sys.stderr.write(f"{code}\n")
    return 1


def _finish(status: int) -> None:
    """End as an interpreter does (other threads first, then atexit), without going back into the grader's code."""
    try:
        threading._shutdown()  # type: ignore[attr-defined]  # noqa: SLF001 - what the interpreter calls; nothing public
        atexit._run_exitfuncs()  # noqa: SLF001
        sys.stdout.flush()
        sys.stderr.flush()
    except BaseException as problem:  # noqa: BLE001 - as above: shown, and the end comes anyway
        _print_exception(problem)
    os._exit(status)


def _print_exception(problem: BaseException) -> None:
    """Print the traceback as Python does, beginning with the learner's own file."""
    part = problem.__traceback__
    while part is not None and Path(part.tb_frame.f_code.co_filename).parent == _OURS:
        part = part.tb_next
    problem.__traceback__ = part
    traceback.print_exception(type(problem), problem, problem.__traceback__)


def _note_thread_failure(hook: threading.ExceptHookArgs, evidence: int) -> None:
    """Show and note an exception that has ended a thread."""
    if hook.exc_value is not None and hook.exc_type is not SystemExit:
        traceback.print_exception(hook.exc_type, hook.exc_value, hook.exc_traceback)
        _note_refused_return(hook.exc_value, evidence)


def _note_refused_return(problem: BaseException, evidence: int) -> None:
    """Note what a callback returned when rclpy refused to send it; its own exception does not say."""
    for frame, _ in traceback.walk_tb(problem.__traceback__):
        note, variable = _RETURNED.get(frame.f_code.co_name, ("", ""))
        if variable in frame.f_locals:
            value = frame.f_locals[variable]
            _send_note(evidence, **{note: "None" if value is None else type(value).__name__})


def _watch_lost_nodes(evidence: int, program: str) -> None:
    """Note the line of a callback that spins its node by another executor than the one that runs it: for good."""
    from rclpy.executors import Executor

    add_node = Executor.add_node

    def add_node_watched(executor: Executor, node: Any) -> bool:
        before = node.executor
        if before is not None and before is not executor and node in before.get_nodes():
            frames = list(traceback.walk_stack(sys._getframe(1)))  # noqa: SLF001 - with None it skips some
            own = [line for frame, line in frames if frame.f_code.co_filename == program]
            if own and any(frame.f_code.co_name == "await_or_execute" for frame, _ in frames):
                _send_note(evidence, lost_in=f"{program}:{own[0]}")
        return bool(add_node(executor, node))

    setattr(Executor, "add_node", add_node_watched)  # noqa: B010 - mypy forbids to assign to a method


def _send_note(evidence: int, **what: object) -> None:
    """Send a note to the grader."""
    os.write(evidence, b"\n" + json.dumps({"note": what}).encode() + b"\n")
