"""Waits for an answer, or for many. Without one: has the program ended, what are its threads doing, does it compute?"""

from __future__ import annotations

import time
from collections import deque
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from rcl_interfaces.srv import ListParameters

from course_kit.grading.checks.context import ANSWER_AGAIN_S, ANSWER_S, GRAPH_STEP_S, SubmissionEndedError
from course_kit.grading.checks.evidence import Evidence, Failed, UnansweredError
from course_kit.grading.diagnosis import causes
from course_kit.grading.diagnosis.tracebacks import Activity, read_activity
from course_kit.ros.parameters import LIST_SERVICE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.model.job import Job, ProcessStatus
    from course_kit.ros.messages import Message
    from course_kit.ros.service import SentRequest, ServiceClient

    EndExplainer = Callable[[ProcessStatus, Job], causes.Cause]  # of what the supervisor knows
    LogExplainer = Callable[[str, Job], causes.Cause | None]  # of what the program has written

RESEND_AFTER_S = 1.0  # what has not been answered for so long is sent again
_NUDGE_S = 1.0  # when nothing has come for so long, rclpy is given something to do, after which it logs what it caught
_GREET_S, _NUDGED_S = 1.0, 0.1  # of a nudge no answer is needed
_ASK_AGAIN_S = 0.5
LOOK_S = 0.3  # how long a program is watched to tell whether it computes
_IDLE_SHARE = 0.5  # below this share of one processor it is waiting, not computing
_STEP_S = 0.004  # how often it is looked: what lies between two looks counts as the grader's lateness


@contextmanager
def explain_end(
    context: CheckContext, evidence: Evidence, why: EndExplainer = causes.explain_end, got: str = "the program ended"
) -> Iterator[None]:
    """Turn the end of the submission, while something is waited for, into a verdict that says why it ended."""
    try:
        yield
    except SubmissionEndedError as ended:
        diagnosis, message = why(ended.process, context.job)
        raise Failed(replace(evidence, got=got), message, diagnosis) from None


def await_answer(  # noqa: PLR0913 - what differs between services, goals and parameters
    context: CheckContext,
    answered: Callable[[], bool],
    evidence: Evidence,
    seconds: float = 0.0,  # if not as long as an answer is usually waited for
    *,
    ended: EndExplainer = causes.explain_call,
    logged: LogExplainer = causes.explain_logged_exception,
) -> None:
    """Wait until something is answered."""
    seconds = seconds or context.patience_s
    clock, too_late = context.clock(), context.time_is_up()
    with explain_end(context, evidence, ended, "no answer: the program ended"):
        if context.wait_until(answered, min(_NUDGE_S, seconds)):
            return
        with context.record.looking_away():  # an executor of several threads tells what a callback has raised when it
            greet_node(context, _NUDGED_S)  # has more to do
        if context.wait_until(answered, seconds - _NUDGE_S):
            return
    if too_late:
        context.spoil()
        why = f"Every answer came, but so slowly that the {context.deadline_s:g} s for this check ran out."
        raise Failed(replace(evidence, got="too late for this answer"), why, "service.blocks")
    raise explain_no_answer(context, evidence, clock.fair_s(), logged)


def greet_node(context: CheckContext, seconds: float = _GREET_S) -> None:
    """Have the node's process know our endpoints: asked last, a question for its parameters is answered after that."""
    node = context.grader_node
    offers = [name for name, _ in node.node.get_service_names_and_types() if name.endswith(LIST_SERVICE)]
    if offers:
        client = node.client(ListParameters, offers[0])
        context.wait_until(client.is_ready, seconds, step_s=GRAPH_STEP_S)
        is_answered(context, client, ListParameters.Request(), seconds)
    else:
        context.wait_until(lambda: False, 0.1)


def is_answered(context: CheckContext, client: ServiceClient, request: Message, seconds: float) -> bool:
    """Whether a server answers within so many seconds, whatever it says; it is asked a second time meanwhile."""
    # On a loaded machine rmw_fastrtps drops a response while the server's process has not noticed the client.
    sent = client.send(request)
    return context.wait_until(lambda: sent.is_answered(_ASK_AGAIN_S), seconds)


def explain_no_answer(
    context: CheckContext, evidence: Evidence, waited_s: float, logged: LogExplainer = causes.explain_logged_exception
) -> UnansweredError:
    """Establish why a program that is still running does not answer."""
    context.spoil()
    seen = current_activity(context)
    busy = is_computing(context)
    evidence = replace(evidence, got=f"no answer within {describe_seconds(waited_s)} s; the program is still running")
    diagnosis, message = _why_silent(context, seen, describe_seconds(waited_s), busy=busy)
    patience_s, context.patience_s = context.patience_s, ANSWER_AGAIN_S
    if diagnosis is None and (cause := logged(context.program.status(fresh=True).stderr, context.job)):
        diagnosis, message = cause
    if waited_s < patience_s and context.time_is_up():
        message += f" This check may take {context.deadline_s:g} s, and no time is left."
    return UnansweredError(evidence, message, diagnosis)


def describe_seconds(waited_s: float, most: float = ANSWER_S) -> str:
    """Seconds as the learner reads them: the whole timeout, or less where a check's deadline came first."""
    return f"{min(round(waited_s, 1), most):g}"


def _why_silent(context: CheckContext, seen: Activity, seconds: str, *, busy: bool) -> causes.Cause:
    job = context.program.asked_job
    if seen.callback is not None:
        where = causes.source_line(job, seen.callback)
        if seen.waits_for_ros or job.text.facts.waits_for_a_future(seen.callback.line):
            message = f"Your callback is stuck in {where}: a deadlock. It blocks the executor that it waits for."
            return "service.deadlock", message
        if busy:
            return "limit.time", f"Your callback was still computing in {where} after {seconds} s."
        return "service.blocks", f"Your callback is blocked in {where}; meanwhile all other requests wait."
    if seen.spinning and job.text.facts.awaits:
        text = "Your callback awaits something that never comes: nothing is left to deliver it."
        return (None if busy else causes.explain_future(job)) or ("service.deadlock", text)
    if seen.known and not seen.spinning:
        where = f" Your program stays in {causes.source_line(job, seen.own)}." if seen.own else ""
        return "start.nothing", f"Your node is on the graph, but nothing spins it, so no callback ever runs.{where}"
    return None, "Your server is running but did not answer."


def is_computing(context: CheckContext) -> bool:
    """Whether the submission uses a processor most of the time, or waits for one; it is watched for a moment."""
    before = context.program.status(fresh=True)
    clock = context.clock()
    context.wait_until(lambda: clock.wall_s() > LOOK_S, LOOK_S, by_deadline=False)
    after = context.program.status(fresh=True)
    return after.cpu_s + after.waited_s - before.cpu_s - before.waited_s > _IDLE_SHARE * clock.wall_s()


def current_activity(context: CheckContext) -> Activity:
    """What the submission's threads are doing now; unknown for other than Python source."""
    return read_activity(context.program.stacks(), context.job.programs)


def call_many(
    context: CheckContext, clients: Sequence[ServiceClient], requests: Sequence[Message], within_s: float
) -> list[Message]:
    """Send all requests, one of each client at a time, and return the responses in their order."""
    sent = f"{len(requests)} requests, never more than {len(clients)} of them waiting for an answer"
    seen = Evidence(sent, f"{len(requests)} answers within {within_s:g} s, each to its own request")
    with explain_end(context, seen, causes.explain_call):
        context.wait_until(lambda: all(client.is_ready() for client in clients), within_s, step_s=_STEP_S)
        turn = context.record.add_sent(seen.sent)
        batch = CallBatch(clients, requests)
        clock = context.clock(batch.lateness)
        context.wait_until(batch.exchange, within_s, step_s=_STEP_S)
        spent, answered = clock.fair_s(), batch.answered
    if answered:
        turn.add_received(f"{answered} of {len(requests)} responses within {spent:.1f} s")
    if answered == len(requests) and spent <= within_s:
        return batch.responses
    context.spoil()
    if answered == 0:
        raise explain_no_answer(context, seen, spent)
    each = spent / answered
    message = (
        f"{answered} of {len(requests)} requests were answered in {spent:.1f} s. That is {each:.2f} s for each answer, "
        f"so the last of {len(clients)} requests that are sent together waits {len(clients) * each:.1f} s."
    )
    raise Failed(replace(seen, got=f"{answered} answers in {spent:.1f} s"), message, "service.blocks")


class CallBatch:
    """Requests on their way, and the responses."""

    def __init__(self, clients: Sequence[ServiceClient], requests: Sequence[Message]) -> None:
        self.responses: list[Message] = [None] * len(requests)
        self._clients, self._requests = clients, requests
        self._waiting = deque(range(len(requests)))
        self._flying: dict[int, SentRequest] = {}
        self._late = [0.0] * len(clients)  # seconds, by client
        self._looked = self._moved = time.monotonic()

    @property
    def answered(self) -> int:
        """How many requests are."""
        return sum(response is not None for response in self.responses)

    def lateness(self) -> float:
        """Seconds by which the grader may have kept the client waiting that suffered most: between two looks."""
        return max(self._late)

    def exchange(self) -> bool:
        """Take in what has come and send what may be sent; True when all is answered."""
        now = time.monotonic()
        for number in [number for number, sent in self._flying.items() if sent.is_answered()]:
            self.responses[number] = self._flying.pop(number).response()
            self._late[number % len(self._late)] += now - self._looked
            self._moved = now
        self._looked = now
        while self._waiting and len(self._flying) < len(self._clients):
            number = self._waiting.popleft()
            self._flying[number] = self._clients[number % len(self._clients)].send(self._requests[number])
        if now - self._moved > RESEND_AFTER_S:
            # Once: the middleware drops a response while the server has not noticed the client, on a loaded machine.
            for number, sent in self._flying.items():
                if number < len(self._clients):
                    sent.is_answered(RESEND_AFTER_S)
        return not self._flying
