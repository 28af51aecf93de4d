"""Why a program does not answer: it has ended, or from what its threads are doing, and whether it computes."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.graded_program import SubmissionEndedError
from course_kit.grading.diagnosis import exceptions, exits
from course_kit.grading.diagnosis.tracebacks import Activity, activity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.model.job import Job
    from course_kit.grading.model.process_status import ProcessStatus

ANSWER_S = 5.0  # how long one answer is waited for
LOOK_S = 0.3  # how long a program is watched to tell whether it computes
_IDLE_SHARE = 0.5  # below this share of one processor it is waiting, not computing


@contextmanager
def explained(
    context: CheckContext,
    evidence: Evidence,
    why: Callable[[ProcessStatus, Job], exits.Cause] = exceptions.of_end,
    got: str = "the program ended",
) -> Iterator[None]:
    """Turn the end of the submission, while something is waited for, into a verdict that says why it ended."""
    try:
        yield
    except SubmissionEndedError as ended:
        diagnosis, message = why(ended.process, context.job)
        raise Failed(replace(evidence, got=got), message, diagnosis) from None


def unanswered(context: CheckContext, shown: str, expected: str, waited_s: float = ANSWER_S) -> Failed:
    """Establish why a program that is still running does not answer."""
    context.spoil()
    seen = doing(context)
    busy = computes(context)
    evidence = Evidence(shown, expected, f"no answer within {told(waited_s)} s; the program is still running")
    diagnosis, message = _why_silent(context, seen, told(waited_s), busy=busy)
    if diagnosis is None and (logged := exits.of_logged(context.program.status().stderr, context.job)):
        diagnosis, message = logged
    if waited_s < ANSWER_S and context.time_is_up():
        message += f" That used up the {context.deadline_s:g} s that this check may take."
    return Failed(evidence, message, diagnosis)


def unanswered_parameters(context: CheckContext, evidence: Evidence, waited_s: float) -> Failed:
    """Establish why a program that lives on has not answered a request about its parameters for so many seconds."""
    logged = exceptions.of_logged(context.program.status(fresh=True).stderr, context.job)
    if logged is None:
        return unanswered(context, evidence.sent, evidence.expected, waited_s)
    context.spoil()
    return Failed(replace(evidence, got=f"no answer within {told(waited_s)} s"), logged[1], logged[0])


def told(waited_s: float, most: float = ANSWER_S) -> str:
    """Seconds as the learner reads them: the whole timeout, or less where a check's deadline came first."""
    return f"{min(round(waited_s, 1), most):g}"


def _why_silent(context: CheckContext, seen: Activity, seconds: str, *, busy: bool) -> exits.Cause:
    job = context.program.asked_job
    if seen.callback is not None:
        where = exits.source_line(job, seen.callback)
        if seen.waits_for_ros or job.facts.waits_for_a_future(seen.callback.line):
            message = f"Your callback is stuck in {where}: a deadlock. It blocks the executor that it waits for."
            return "service.deadlock", message
        if busy:
            return "limit.time", f"Your callback was still computing in {where} after {seconds} s."
        return "service.blocks", f"Your callback is blocked in {where}; meanwhile all other requests wait."
    if seen.spinning and job.facts.awaits:
        text = "Your callback awaits something that never comes: nothing is left to deliver it."
        return (None if busy else exits.of_future(job)) or ("service.deadlock", text)
    if seen.known and not seen.spinning:
        where = f" It is in {exits.source_line(job, seen.own)}." if seen.own else ""
        return "start.nothing", f"Your node is on the graph, but nothing spins it, so no callback ever runs.{where}"
    return None, "Your server is running but did not answer."


def computes(context: CheckContext) -> bool:
    """Whether the submission uses a processor most of the time, or waits for one; it is watched for a moment."""
    before = context.program.status(fresh=True)
    clock = context.clock()
    with context.after_the_verdict():
        context.wait_until(lambda: clock.wall() > LOOK_S, LOOK_S)
    after = context.program.status(fresh=True)
    return after.cpu_s + after.waited_s - before.cpu_s - before.waited_s > _IDLE_SHARE * clock.wall()


def doing(context: CheckContext) -> Activity:
    """What the submission's threads are doing now; unknown for other than Python source."""
    return activity(context.program.stacks(), context.job.programs)


def spins(context: CheckContext) -> bool:
    """Whether an executor is at work, so that the node's making is over."""
    return context.job.mode != "run" or doing(context).spinning
