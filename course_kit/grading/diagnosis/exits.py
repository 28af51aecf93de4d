"""Why a submission ended: from its exit, its limits and its last output to a code of the catalogue."""

from __future__ import annotations

import importlib
import pkgutil
import re
import signal
import sys
from pathlib import PurePath
from typing import TYPE_CHECKING

from course_kit.grading.diagnosis.tracebacks import Frame, TracebackException, last_exception
from course_kit.grading.model.submission import describe_line
from course_kit.ros.names import nearest_name

if TYPE_CHECKING:
    from course_kit.grading.model.job import Job, ProcessStatus

_FIELD = re.compile(r"'(?P<field>\w+)' field must be (?:a sub message )?of type '(?P<type>[\w.]+)'")
_NO_MODULE = re.compile(r"No module named '(?P<module>[\w.]+)'")
_NO_CONTEXT = re.compile(r"__enter__|context manager")
_NO_NAME = re.compile(r"cannot import name '(?P<name>\w+)' from '(?P<module>[\w.]+)'")
# The grader's call of the class is no line of the submission, so that Python's words about it stand without a frame.
_NEEDS_ARGUMENTS = re.compile(r"TypeError: (?P<name>\w+)\.__init__\(\) missing .* arguments?: (?P<missing>.*)")
_TOO_MANY = ("can't start new thread", "[Errno 11] Resource temporarily unavailable")
# Packages of the course that may exist as text only, and so are not among the installed modules.
_INTERFACE_PACKAGES = ("course_interfaces", "example_interfaces")
# What is imported to see what is in it. What a traceback names is the submission's choice, and importing is running.
_HARMLESS = re.compile(r"rclpy(?:\.\w+)*|course_kit\.robot|\w+_(?:msgs|srvs|interfaces)\.(?:msg|srv|action)")
_SECOND_SPIN = "Executor is already spinning"
_RUNS_CALLBACKS = "await_or_execute"  # the function of rclpy
_OF_LAUNCH = re.compile(r"^\[ERROR\] \[launch\]: (.{1,400})", re.MULTILINE)
_LONGEST_LINE = 200  # characters of a learner's line that are repeated

Cause = tuple["str | None", str]
"""A diagnosis, or None when the cause is not established, and what happened in one or two sentences."""


def source_line(job: Job, place: int | Frame) -> str:
    """The learner's own line and where it stands, `line 12: return response`; notebooks: `cell 3, line 2: ...`."""
    line = place.line if isinstance(place, Frame) else place
    if isinstance(place, Frame) and (name := PurePath(place.file).name) in job.files:
        job = job.for_program(name)
    lines = job.source.split("\n")
    text = lines[line - 1].strip()[:_LONGEST_LINE] if 0 < line <= len(lines) else ""
    found = f"{job.name}, {describe_line(job.places, line)}" if job.files else describe_line(job.places, line)
    return f"{found}: {text}" if text else found


def name_line(job: Job, frame: Frame | None) -> str:
    """` in line 12: return response`, to follow on what happened there; nothing where it is not known."""
    return f" in {source_line(job, frame)}" if frame else ""


def explain_limit(process: ProcessStatus, job: Job) -> Cause | None:
    """The limit that ended the submission, if one did."""
    limits = job.limits
    raised = last_exception(process.stderr, job.programs)
    limit = process.limit
    if limit is None and raised is not None:
        if raised.type == "MemoryError":
            limit = "memory"
        elif any(text in raised.text for text in _TOO_MANY):
            limit = "processes"
    elif limit is None and any(text in process.stderr for text in _TOO_MANY):  # many at once, one through the other
        limit = "processes"
    if limit is None and "std::bad_alloc" in process.stderr:
        limit = "memory"
    computed = (
        limits.cpu_s if process.signal == signal.SIGXCPU else process.cpu_s
    )  # what is dead is not counted any more
    causes = {
        "time": f"Your program was stopped because it did not end: it computed for {computed:.0f} s. "
        f"It may compute for {limits.cpu_s} s, and take {limits.wall_s:g} s in all.",
        "memory": f"Your program needed more than the {limits.memory_mb} MB of memory it may use.",
        "output": f"Your program was stopped: it printed more than {limits.output_kb} kB.",
        "processes": f"Your program started more than the {limits.tasks} processes and threads it "
        "may have at the same time.",
    }
    return (f"limit.{limit}", causes[limit]) if limit else None


def explain_start(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended before it could be asked anything."""
    if cause := explain_limit(process, job):
        return cause
    if process.notes.get("functions") is not None:
        return "start.nothing", _no_class(process, job)
    raised = last_exception(process.stderr, job.programs)
    if raised is None:
        return _explain_constructor(process) or explain_exit(process)
    where = name_line(job, raised.own)
    if raised.type in ("ModuleNotFoundError", "ImportError"):
        return "start.import", f"{raised.describe()}{where}. {_suggest_module(raised)}".strip()
    if _NO_CONTEXT.search(raised.text) and raised.own and "rclpy.init(" in source_line(job, raised.own):
        return "ros.newer", f"Your program uses `with` for rclpy.init(){where}."
    return "start.crash", f"Your program ended with {raised.describe()}{where}, before it could be asked anything."


def _explain_constructor(process: ProcessStatus) -> Cause | None:
    """The class that cannot be made without arguments, if that is what ended the submission."""
    match = _NEEDS_ARGUMENTS.fullmatch(process.stderr.rstrip().rpartition("\n")[2])
    if match is None:
        return None
    name, missing = match["name"], match["missing"]
    return "start.crash", f"Your class is made as {name}(), without arguments, but its __init__ needs {missing}."


def explain_exit(process: ProcessStatus) -> Cause:
    """How it ended, when nothing tells why."""
    if launch := _OF_LAUNCH.findall(process.stderr):
        return "start.crash", f"Your launch file cannot be run: {launch[-1].rstrip('.')}."
    how = f"by signal {_signal_name(process.signal)}" if process.signal else f"with exit code {process.exit_code}"
    return "start.exit", f"Your program ended {how} before it could answer anything."


def explain_call(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended while it was handling a call."""
    return explain_limit(process, job) or _explain_callback(process, job) or explain_exit(process)


def _explain_callback(process: ProcessStatus, job: Job) -> Cause | None:
    returned = process.notes.get("returned")
    if returned == "None":
        return (
            "service.no_return",
            "Your callback returned None; rclpy had nothing to send, and your node ended.",
        )
    if returned is not None:
        text = f"Your callback returned an object of type {returned}; rclpy refused to send it, and your node ended."
        return "service.wrong_return", text
    if process.signal:
        return None, f"Your program ended by signal {_signal_name(process.signal)} while it was handling a request."
    if process.notes.get("exit_in_callback"):
        return "service.exception", "Your callback ended the whole program (SystemExit). The client got no answer."
    return explain_logged_exception(process.stderr, job)


def explain_logged_exception(stderr: str, job: Job) -> Cause | None:
    """What the output of a program that is still running says about an exception in its callback."""
    raised = last_exception(stderr, job.programs)
    return _explain_exception(raised, job) if raised is not None else None


def _explain_exception(raised: TracebackException, job: Job) -> Cause:
    if raised.frames and raised.frames[-1].function == "send_response" and raised.type == "TypeError":
        return (
            "service.wrong_return",
            "Your callback did not return the response it was given; rclpy refused to send it.",
        )
    if cause := explain_respin(raised, job) or explain_field(raised, job):
        return cause
    where = name_line(job, raised.own)
    return "service.exception", f"Your callback raised {raised.describe()}{where}. The client got no answer."


def explain_respin(raised: TracebackException, job: Job) -> Cause | None:
    """The callback that spins: rclpy refuses that from 7.1.9 on, and waits for ever before; both is a deadlock."""
    in_callback = any(frame.function == _RUNS_CALLBACKS for frame in raised.frames)
    if raised.text != _SECOND_SPIN or raised.own is None or not in_callback:
        return None
    place = source_line(job, raised.own)
    message = f"Your callback spins in {place}: there it would wait for ROS while ROS waits for it. rclpy refuses that."
    return "service.deadlock", message


def explain_field(raised: TracebackException, job: Job) -> Cause | None:
    """The field of a message that refused its value, if that is what was raised."""
    match = _FIELD.search(raised.text)
    if match is None:
        return None
    where = f" in {source_line(job, raised.own)}" if raised.own else ""
    text = f"The field '{match['field']}' must be a {match['type']}, but something else was put into it{where}."
    return "field.type", text


def explain_future(job: Job) -> Cause | None:
    """Why a callback that awaits a Future of the program's own is never resumed, while nothing computes or blocks."""
    if not (job.facts.awaits and job.facts.future):
        return None
    where = source_line(job, job.facts.future)
    return "service.future", f"A callback awaits a Future, probably the one made in {where}; nothing else is running."


def _no_class(process: ProcessStatus, job: Job) -> str:
    nodes, classes, functions = (process.notes.get(key) or [] for key in ("node_classes", "classes", "functions"))
    if nodes and job.own_start:
        found = f"the Node class {', '.join(map(str, nodes))}, but starts no node: write a `main`, and call it"
    elif nodes:
        found = f"several Node classes ({', '.join(map(str, nodes))}), none of them called {job.class_name}"
    elif classes:
        found = f"the class {', '.join(map(str, classes))}, which is not an rclpy Node"
    elif functions:
        found = f"the function {', '.join(map(str, functions))}, but nothing calls it"
    else:
        found = "no class at all"
    return f"Your program ran to its end without making a node. It defines {found}."


def _suggest_module(raised: TracebackException) -> str:
    if match := _NO_MODULE.search(raised.text):
        wanted = match["module"].partition(".")[0]
        known = {module.name for module in pkgutil.iter_modules()} | set(sys.stdlib_module_names)
        known.update(_INTERFACE_PACKAGES)
        if wanted in known:  # the package is right, something in it is not
            return f"There is a package {wanted}, but it has no such part."
    elif match := _NO_NAME.search(raised.text):
        wanted, known = match["name"], _names_in(match["module"])
    else:
        return ""
    near = nearest_name(wanted, known)
    return f"The nearest name is {near}." if near else ""


def _names_in(module: str) -> set[str]:
    """What can be imported from a module; nothing where importing it here would not do."""
    loaded = sys.modules.get(module)
    try:
        if loaded is None and _HARMLESS.fullmatch(module):
            loaded = importlib.import_module(module)
    except Exception:  # noqa: BLE001 - no such name, or it is not whole
        return set()
    return set(dir(loaded)) if loaded is not None else set()


def _signal_name(number: int | None) -> str:
    try:
        return signal.Signals(number or 0).name
    except ValueError:
        return str(number)
