"""What went wrong in a callback of a topic, a timer or a goal, or in the one that checks parameters.

An exception in one of these ends a spinning rclpy program just as in a service callback, but what it means for the
others on the graph is different, and so is what the learner reads. A goal lives on, and ends otherwise.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit.grading.diagnosis import exits
from course_kit.grading.diagnosis.tracebacks import TracebackException, last_exception

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.diagnosis.exits import Cause
    from course_kit.grading.diagnosis.tracebacks import Activity
    from course_kit.grading.model.job import Job, ProcessStatus

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


def explain_end(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended that was up."""
    if cause := exits.explain_limit(process, job):
        return cause
    if process.notes.get("exit_in_callback"):
        return None, "One of your callbacks ended the whole program (SystemExit)."
    return explain_logged(process.stderr, job) or exits.explain_exit(process)


def explain_start(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended before it was up, mistakes with its parameters told apart."""
    if exits.explain_limit(process, job) is None:
        if INVALID_RESULT in process.stderr:  # rclpy warns of it, whoever catches the exception that follows
            message = (
                "Your set-parameters callback also runs on each declaration, and it did not return a "
                "SetParametersResult."
            )
            return "parameter.bad_callback", message
        raised = last_exception(process.stderr, job.programs)
        if raised is not None and (cause := _explain_parameters(raised, job)):
            return cause
    return exits.explain_start(process, job)


def explain_logged(stderr: str, job: Job) -> Cause | None:
    """What the last exception in a program's output means, None without one."""
    raised = last_exception(stderr, job.programs)
    if raised is None:
        return None
    cause = exits.explain_respin(raised, job) or _explain_parameters(raised, job) or exits.explain_field(raised, job)
    where = exits.name_line(job, raised.own)
    return cause or (None, f"Your program raised {raised.describe()}{where}, and nothing caught it.")


def _explain_parameters(raised: TracebackException, job: Job) -> Cause | None:
    where = exits.name_line(job, raised.own)
    if raised.type == "ParameterNotDeclaredException":
        return "parameter.undeclared", f"{raised.text}{where}."
    functions = [frame.function for frame in raised.frames]
    judging = _JUDGES in functions and any(
        frame.file in job.programs for frame in raised.frames[functions.index(_JUDGES) + 1 :]
    )
    if judging:
        message = (
            f"Your set-parameters callback raised {raised.describe()}{where}: the caller who set the "
            "value gets no answer."
        )
        return "parameter.bad_callback", message
    if raised.type == "InvalidParameterTypeException":
        return "parameter.type", f"{raised.text}{where}."
    return None


def explain_program(process: ProcessStatus, job: Job) -> Cause:
    """Why a submission ended while a goal was under way."""
    if cause := exits.explain_limit(process, job):
        return cause
    raised = last_exception(process.stderr, job.programs)
    if raised is not None and _in_execute(raised):
        if _NOT_A_RESULT.search(raised.text):
            what = process.notes.get("result") or "something else"
            text = (
                f"Your execute callback returned {what}; rclpy could not send that as the result, and your node ended."
            )
            return "action.no_result", text
        return _explain_exception(raised, job)
    return exits.explain_call(process, job)


def explain_goal_exception(process: ProcessStatus, job: Job) -> Cause | None:
    """What a program that lives on has printed about an exception in its execute callback."""
    raised = last_exception(process.stderr, job.programs)
    if raised is None or not _in_execute(raised):
        return None
    return exits.explain_limit(process, job) or _explain_exception(raised, job)


def explain_status(name: str, process: ProcessStatus, job: Job) -> Cause:
    """Why a goal that should have ended in another way ended as ABORTED, SUCCEEDED or CANCELED."""
    if cause := explain_goal_exception(process, job):
        return cause
    if _NOT_ENDED in process.stderr:
        text = f"Your execute callback returned without saying how the goal ended, so rclpy made it {name}."
        return "action.no_terminal", text
    if name == "ABORTED" and job.mode != "run":  # the log, which would tell these two apart, may be another's
        return None, "The goal was ABORTED: your server called abort(), or never said how the goal ended."
    return "action.wrong_terminal", f"Your server itself ended the goal as {name}."


def explain_silence(look: Callable[[], Activity], over: str, seconds: float, process: ProcessStatus, job: Job) -> Cause:
    """Why no result came from a program that lives on, whose threads can be looked at."""
    if over:
        cause = explain_goal_exception(process, job)
        return cause or (None, f"The goal ended as {over}, but its result was never sent.")
    looks = [look() for _ in range(_LOOKS)]
    at_work = [seen.callback for seen in looks if seen.callback is not None]
    if not at_work:
        if cause := exits.explain_future(job):
            return cause
        return None, f"The goal was accepted but had not ended {seconds:.1f} s later, and no callback is working on it."
    where = exits.source_line(job, at_work[0])
    if all(seen.waits_for_ros for seen in looks if seen.callback is not None):
        return (
            "service.deadlock",
            f"Your execute callback is stuck in {where}: it waits for ROS, but blocks the executor it waits for.",
        )
    return "limit.time", f"After {seconds:.1f} s your execute callback was still running, in {where}."


def _in_execute(raised: TracebackException) -> bool:
    return any(frame.function == _EXECUTE for frame in raised.frames)


def _explain_exception(raised: TracebackException, job: Job) -> Cause:
    if fault := exits.explain_respin(raised, job) or exits.explain_field(raised, job):
        return fault
    where = exits.name_line(job, raised.own)
    if match := _TRANSITION.search(raised.text):
        verb = _VERBS.get(match["event"], match["event"])
        text = (
            f"Your execute callback called {verb}{where}, when the goal was already {match['state']}. "
            "rclpy refused that."
        )
        return "action.wrong_terminal", text
    text = f"Your execute callback raised {raised.describe()}{where}. rclpy then ends the goal with an empty result."
    return None, text
