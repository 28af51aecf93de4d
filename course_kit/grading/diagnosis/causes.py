"""Why a submission ended, or an answer did not come: from exit, limits and last output to a code of the catalogue.

An exception in any callback ends a spinning rclpy program, but what it means for the others on the graph is different
for a service, a topic or a timer, and the check of parameters. A goal lives on, and ends otherwise.
"""

from __future__ import annotations

import importlib
import pkgutil
import re
import signal
import sys
from contextlib import suppress
from pathlib import PurePath
from typing import TYPE_CHECKING

from course_kit.grading.diagnosis.tracebacks import Frame, TracebackException, last_exception
from course_kit.ros.names import nearest_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.diagnosis.tracebacks import Activity
    from course_kit.grading.model.job import Job, ProcessStatus

_FIELD = re.compile(r"'(?P<field>\w+)' field must be (?:a sub message )?of type '(?P<type>[\w.]+)'")
_NO_MODULE = re.compile(r"No module named '(?P<module>[\w.]+)'")
_OF_MODULE = re.compile(r"(?:module|from|;) '(?P<name>\w+)'")
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
# Where rclpy (Node in node.py) calls the callbacks of add_on_set_parameters_callback, on declaration as well.
_JUDGES = "_set_parameters_atomically_common"
# What rclpy says for a callback that returns something else than a SetParametersResult.
INVALID_RESULT = "Callback returned an invalid type"
_EXECUTE = "_execute_goal"  # rclpy's function around the execute callback
_NOT_A_RESULT = re.compile(r"'result' field must be a sub message")
_TRANSITION = re.compile(r"from state (?P<state>\w+) with event (?P<event>\w+)")
_NOT_ENDED = "Goal state not set, assuming aborted"  # rclpy's warning
_LOOKS = 3  # at what the program does: on a loaded machine one may come out incomplete
_VERBS = {"SUCCEED": "succeed()", "ABORT": "abort()", "CANCELED": "canceled()"}

Cause = tuple["str | None", str]
"""A diagnosis, or None when the cause is not established, and what happened in one or two sentences."""


def source_line(job: Job, place: int | Frame) -> str:
    """The learner's own line and where it stands, `line 12: return response`; notebooks: `cell 3, line 2: ...`."""
    line = place.line if isinstance(place, Frame) else place
    if isinstance(place, Frame) and (name := PurePath(place.file).name) in job.text.files:
        job = job.for_program(name)
    lines = job.text.source.split("\n")
    text = lines[line - 1].strip()[:_LONGEST_LINE] if 0 < line <= len(lines) else ""
    found = f"{job.text.program}, {job.text.describe_line(line)}" if job.text.files else job.text.describe_line(line)
    return f"{found}: {text}" if text else found


def name_line(job: Job, frame: Frame | None) -> str:
    """` in line 12: return response`, to follow on what happened there; nothing where it is not known."""
    return f" in {source_line(job, frame)}" if frame else ""


def explain_limit(process: ProcessStatus, job: Job) -> Cause | None:
    """The limit that ended the submission, if one did."""
    limits = job.limits
    raised = last_exception(process.stderr, job.programs)
    limit = process.limit
    if limit is None:
        printed = raised.text if raised else process.stderr  # many at once, one through the other
        if any(text in printed for text in _TOO_MANY):
            limit = "processes"
        elif (raised and raised.type == "MemoryError") or "std::bad_alloc" in process.stderr:
            limit = "memory"
    computed_s = limits.cpu_s if process.signal == signal.SIGXCPU else process.cpu_s  # what is dead counts no more
    allowed = f"It may compute for {limits.cpu_s} s, and take {limits.wall_s:g} s in all."
    causes = {
        "time": f"was stopped because it did not end: it computed for {computed_s:.0f} s. {allowed}",
        "memory": f"needed more than the {limits.memory_mb} MB of memory it may use.",
        "output": f"was stopped: it printed more than {limits.output_kb} kB.",
        "processes": f"started more than the {limits.tasks} processes and threads it may have at the same time.",
    }
    return (f"limit.{limit}", f"Your program {causes[limit]}") if limit else None


def explain_start(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended before it could be asked anything."""
    raised = last_exception(process.stderr, job.programs)
    cause = explain_limit(process, job)
    if cause is None and INVALID_RESULT in process.stderr:  # rclpy warns of it, whoever catches what follows
        text = "callback also runs on each declaration, and it did not return a SetParametersResult."
        cause = "parameter.bad_callback", f"Your set-parameters {text}"
    if cause is None and raised is not None:
        cause = _explain_parameters(raised, job)
    if cause is None and process.notes.get("functions") is not None:
        cause = "start.nothing", _no_class(process, job)
    if cause is not None:
        return cause
    if raised is None:
        return explain_exit(process)
    where = name_line(job, raised.own)
    name = match["name"] if (match := _OF_MODULE.search(raised.text)) else ""
    if f"{name}.py" in job.programs and name in _known_modules():
        hides = f"Your file is called {name}.py, and Python takes it for the module {name}{where}."
        return "start.crash", f"{hides} Give your file another name."
    if raised.type in ("ModuleNotFoundError", "ImportError"):
        return "start.import", f"{raised.describe()}{where}. {_suggest_module(raised)}".strip()
    if _NO_CONTEXT.search(raised.text) and raised.own and "rclpy.init(" in source_line(job, raised.own):
        return "ros.newer", f"Your program uses `with` for rclpy.init(){where}."
    error = raised.describe().rstrip(".")
    return "start.crash", f"Before it could answer anything, your program ended{where}. The error: {error}."


def explain_exit(process: ProcessStatus) -> Cause:
    """How it ended, when nothing tells why."""
    if launch := _OF_LAUNCH.findall(process.stderr):
        return "start.crash", f"Your launch file cannot be run: {launch[-1].rstrip('.')}."
    if match := _NEEDS_ARGUMENTS.fullmatch(process.stderr.rstrip().rpartition("\n")[2]):
        made = f"is made as {match['name']}(), without arguments, but its __init__ needs {match['missing']}"
        return "start.crash", f"Your class {made}."
    how = f"by signal {_signal_name(process.signal)}" if process.signal else f"with exit code {process.exit_code}"
    return "start.exit", f"Your program ended {how} before it could answer anything."


def explain_call(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended while it was handling a call."""
    if cause := explain_limit(process, job):
        return cause
    returned = process.notes.get("returned")
    if returned == "None":
        return "service.no_return", "Your callback returned None; rclpy had nothing to send, and your node ended."
    if returned is not None:
        text = f"Your callback returned an object of type {returned}; rclpy refused to send it, and your node ended."
        return "service.wrong_return", text
    if process.signal:
        return None, f"Your program ended by signal {_signal_name(process.signal)} while it was handling a request."
    if process.notes.get("exit_in_callback"):
        return "service.exception", "Your callback ended the whole program (SystemExit). The client got no answer."
    return explain_logged_exception(process.stderr, job) or explain_exit(process)


def explain_logged_exception(stderr: str, job: Job) -> Cause | None:
    """What the output of a program that is still running says about an exception in its callback."""
    raised = last_exception(stderr, job.programs)
    if raised is None:
        return None
    if raised.frames and raised.frames[-1].function == "send_response" and raised.type == "TypeError":
        text = "Your callback did not return the response it was given; rclpy refused to send it."
        return "service.wrong_return", text
    text = f"Your callback raised {raised.describe()}{name_line(job, raised.own)}. The client got no answer."
    return _explain_anywhere(raised, job) or ("service.exception", text)


def _explain_anywhere(raised: TracebackException, job: Job) -> Cause | None:
    """What means the same in each callback: it spins, or puts into a field what does not belong there."""
    in_callback = any(frame.function == _RUNS_CALLBACKS for frame in raised.frames)
    if raised.text == _SECOND_SPIN and raised.own is not None and in_callback:
        # rclpy refuses that from 7.1.9 on, and waits for ever before; both is a deadlock.
        where = f"in {source_line(job, raised.own)}: there it would wait for ROS while ROS waits for it"
        return "service.deadlock", f"Your callback spins {where}. rclpy refuses that."
    if match := _FIELD.search(raised.text):
        what = f"must be a {match['type']}, but something else was put into it{name_line(job, raised.own)}."
        return "field.type", f"The field '{match['field']}' {what}"
    return None


def explain_future(job: Job) -> Cause | None:
    """Why a callback that awaits a Future of the program's own is never resumed, while nothing computes or blocks."""
    if not (job.text.facts.awaits and job.text.facts.future):
        return None
    where = source_line(job, job.text.facts.future)
    return "service.future", f"A callback awaits a Future, probably the one made in {where}; nothing else is running."


def explain_end(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended that was up."""
    if cause := explain_limit(process, job):
        return cause
    if process.notes.get("exit_in_callback"):
        return None, "One of your callbacks ended the whole program (SystemExit)."
    return explain_logged(process.stderr, job) or explain_exit(process)


def explain_logged(stderr: str, job: Job) -> Cause | None:
    """What the last exception in a program's output means, None without one."""
    raised = last_exception(stderr, job.programs)
    if raised is None:
        return None
    text = f"Your program raised {raised.describe()}{name_line(job, raised.own)}, and nothing caught it."
    return _explain_parameters(raised, job) or _explain_anywhere(raised, job) or (None, text)


def _explain_parameters(raised: TracebackException, job: Job) -> Cause | None:
    where = name_line(job, raised.own)
    if raised.type == "ParameterNotDeclaredException":
        return "parameter.undeclared", f"{raised.text}{where}."
    functions = [frame.function for frame in raised.frames]
    judged = raised.frames[functions.index(_JUDGES) + 1 :] if _JUDGES in functions else ()
    if raised.text != _SECOND_SPIN and any(frame.file in job.programs for frame in judged):
        what = f"raised {raised.describe()}{where}: the caller who set the value gets no answer"
        return "parameter.bad_callback", f"Your set-parameters callback {what}."
    if raised.type == "InvalidParameterTypeException":
        return "parameter.type", f"{raised.text}{where}."
    return None


def explain_program(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended while a goal was under way."""
    raised = last_exception(process.stderr, job.programs)
    no_result = raised is not None and _in_execute(raised) and _NOT_A_RESULT.search(raised.text)
    if no_result and explain_limit(process, job) is None:
        what = process.notes.get("result") or "something else"
        text = f"Your execute callback returned {what}; rclpy could not send that as the result, and your node ended."
        return "action.no_result", text
    return explain_goal_exception(process, job) or explain_call(process, job)


def explain_goal_exception(process: ProcessStatus, job: Job) -> Cause | None:
    """What a program has printed about an exception in its execute callback."""
    raised = last_exception(process.stderr, job.programs)
    if raised is None or not _in_execute(raised):
        return None
    if cause := explain_limit(process, job) or _explain_anywhere(raised, job):
        return cause
    where = name_line(job, raised.own)
    if raised.type == "TypeError" and raised.frames[-1].function == "publish_feedback":
        text = f"Your execute callback gave publish_feedback() something other than the action's Feedback{where}."
        return None, f"{text} rclpy then ends the goal with an empty result."
    if match := _TRANSITION.search(raised.text):
        verb = f"{_VERBS.get(match['event'], match['event'])}{where}"
        text = f"Your execute callback called {verb}, when the goal was already {match['state']}. rclpy refused that."
        return "action.wrong_terminal", text
    text = f"Your execute callback raised {raised.describe()}{where}. rclpy then ends the goal with an empty result."
    return None, text


def explain_status(name: str, process: ProcessStatus, job: Job) -> Cause:
    """Why a goal that should have ended in another way ended as ABORTED, SUCCEEDED or CANCELED."""
    if cause := explain_goal_exception(process, job):
        return cause
    if _NOT_ENDED in process.stderr:
        text = f"Your execute callback returned without saying how the goal ended, so rclpy made it {name}."
        return "action.no_terminal", text
    if name == "ABORTED" and job.mode != "run":  # the log, which would tell these two apart, may be another's
        return None, "The goal was ABORTED: your server called abort(), raised an error, or never said how it ended."
    return "action.wrong_terminal", f"Your server itself ended the goal as {name}."


def explain_silence(look: Callable[[], Activity], over: str, seconds: float, process: ProcessStatus, job: Job) -> Cause:
    """Why no result came from a program that lives on, whose threads can be looked at."""
    if over:
        why = f"The goal ended as {over}, but its result was never sent."
        return explain_goal_exception(process, job) or (None, why)
    looks = [look() for _ in range(_LOOKS)]
    at_work = [seen.callback for seen in looks if seen.callback is not None]
    if not at_work:
        text = f"The goal was accepted but had not ended {seconds:.1f} s later, and no callback is working on it."
        return explain_future(job) or (None, text)
    where = source_line(job, at_work[0])
    if all(seen.waits_for_ros for seen in looks if seen.callback is not None):
        text = f"Your execute callback is stuck in {where}: it waits for ROS, but blocks the executor it waits for."
        return "service.deadlock", text
    return "limit.time", f"After {seconds:.1f} s your execute callback was still running, in {where}."


def _in_execute(raised: TracebackException) -> bool:
    return any(frame.function == _EXECUTE for frame in raised.frames)


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
        known = _known_modules()
        if wanted in known:  # the package is right, something in it is not
            return f"There is a package {wanted}, but it has no such part."
    elif match := _NO_NAME.search(raised.text):
        wanted, known = match["name"], _names_in(match["module"])
    else:
        return ""
    near = nearest_name(wanted, known)
    return f"The nearest name is {near}." if near else ""


def _known_modules() -> set[str]:
    return {module.name for module in pkgutil.iter_modules()}.union(sys.stdlib_module_names, _INTERFACE_PACKAGES)


def _names_in(module: str) -> set[str]:
    """What can be imported from a module; nothing where importing it here would not do."""
    with suppress(Exception):  # no such name, or it is not whole
        if module in sys.modules or _HARMLESS.fullmatch(module):
            return set(dir(importlib.import_module(module)))
    return set()


def _signal_name(number: int) -> str:
    return next((known.name for known in signal.Signals if known == number), str(number))
