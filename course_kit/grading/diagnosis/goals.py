"""Why a goal ended in another way than it should: from its status, the program's log and output to a code."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit.grading.diagnosis import exits
from course_kit.grading.diagnosis.tracebacks import TracebackException, last_exception

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.diagnosis.exits import Cause
    from course_kit.grading.diagnosis.tracebacks import Activity
    from course_kit.grading.model.job import Job
    from course_kit.grading.model.process_status import ProcessStatus

_EXECUTE = "_execute_goal"  # rclpy's function around the execute callback
_NOT_A_RESULT = re.compile(r"'result' field must be a sub message")
_TRANSITION = re.compile(r"from state (?P<state>\w+) with event (?P<event>\w+)")
_NOT_ENDED = "Goal state not set, assuming aborted"  # rclpy's warning
_LOOKS = 3  # at what the program does: on a loaded machine one may come out incomplete
_VERBS = {"SUCCEED": "succeed()", "ABORT": "abort()", "CANCELED": "canceled()"}


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
