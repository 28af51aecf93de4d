"""Many calls at once: what a service does when more than one client asks."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.discovery import RESEND_AFTER_S
from course_kit.grading.diagnosis import exits
from course_kit.grading.diagnosis.exceptions import explained
from course_kit.grading.diagnosis.hangs import unanswered
from course_kit.grading.model.bounds import bounded
from course_kit.grading.sandbox import scheduling

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.endpoints import Service
    from course_kit.ros.messages import Message
    from course_kit.ros.service import SentRequest, ServiceClient

_STEP_S = 0.004  # how often it is looked: what lies between two looks counts as the grader's lateness
_WORTHWHILE = 0.4  # of the requests answered when half the time is over


@dataclass(frozen=True)
class Load:
    """How requests are sent.

    Attributes:
        clients: so many clients take turns.
        unanswered: at most so many requests wait for an answer at a time (a service keeps 10 by default).
        seconds: within which all are to be answered.
    """

    clients: int
    unanswered: int
    seconds: float


def call_many(
    context: CheckContext, service: Service, requests: Sequence[Message], load: Load, evidence: Evidence
) -> list[Message]:
    """Send all requests and return the responses in their order.

    Args:
        context: the check's.
        service: which service.
        requests: what is asked.
        load: by how many clients, and within how many seconds.
        evidence: what the check has so far.

    Raises:
        Failed: not all were answered in time, with service.blocks when they came one by one but too slowly.
    """
    clients = [service.client(context.grader_node, number) for number in range(load.clients)]
    with explained(context, evidence, exits.of_call):
        context.wait_until(lambda: all(client.is_ready() for client in clients), load.seconds, step_s=_STEP_S)
        turn = context.record.sent(evidence.sent)
        late = Lateness()
        clock = context.clock(late.seconds)
        responses = _run(context, clients, requests, load, late)
        spent = clock.fair()
    answered = sum(response is not None for response in responses)
    if answered:
        turn.came(f"{answered} of {len(requests)} responses within {spent:.1f} s")
    if answered == len(requests) and spent <= load.seconds:
        return responses
    context.spoil()
    if answered == 0:
        raise unanswered(context, evidence.sent, evidence.expected, spent)
    each = spent / answered
    message = (
        f"{answered} of {len(requests)} requests were answered in {spent:.1f} s, one in {each:.2f} s: "
        f"the last of {load.clients} clients that ask together waits {load.clients * each:.1f} s."
    )
    raise Failed(replace(evidence, got=f"{answered} answers in {spent:.1f} s"), message, "service.blocks")


class Lateness:
    """By how much the grader may have been late, on a loaded machine, in seeing what had come.

    An answer that is found had come since the last look; it lay there for no longer than the time between the two.
    Time between looks that find nothing was not lost: nothing was there.
    """

    def __init__(self) -> None:
        self._looked = time.monotonic()
        self._late = 0.0
        self._before = scheduling.own_waiting(helpers_only=True)

    def look(self, *, found: bool) -> None:
        """Take note of a look, and of whether it found anything."""
        now = time.monotonic()
        if found:
            self._late += now - self._looked
        self._looked = now

    def seconds(self) -> float:
        """The lateness so far; that of the threads which bring the answers included."""
        return max(self._late, scheduling.own_waiting(helpers_only=True) - self._before)


class LoadRequest:
    """The requests on their way, and the responses."""

    def __init__(
        self, clients: Sequence[ServiceClient], requests: Sequence[Message], unanswered: int, late: Lateness
    ) -> None:
        self.responses: list[Message] = [None] * len(requests)
        self._clients, self._requests, self._unanswered, self._late = clients, requests, unanswered, late
        self._waiting = deque(range(len(requests)))
        self._flying: dict[int, SentRequest] = {}
        self._moved = time.monotonic()

    def done(self) -> bool:
        """Take in what has come and send what may be sent; True when all is answered."""
        came = {number: bounded(sent.response()) for number, sent in self._flying.items() if sent.answered()}
        self._late.look(found=bool(came))
        for number, response in came.items():
            self.responses[number] = response
            del self._flying[number]
        while self._waiting and len(self._flying) < self._unanswered:
            number = self._waiting.popleft()
            self._flying[number] = self._clients[number % len(self._clients)].send(self._requests[number])
        if came:
            self._moved = time.monotonic()
        elif time.monotonic() - self._moved > RESEND_AFTER_S:
            self._send_first_ones_again()
        return not self._flying

    def _send_first_ones_again(self) -> None:
        """Once: the middleware drops a response while the server has not noticed the client, on a loaded machine."""
        for number, sent in self._flying.items():
            if number < len(self._clients) and sent.sent == 1:
                sent.send_again()


def _run(
    context: CheckContext, clients: Sequence[ServiceClient], requests: Sequence[Message], load: Load, late: Lateness
) -> list[Message]:
    exchange = LoadRequest(clients, requests, load.unanswered, late)
    if not context.wait_until(exchange.done, load.seconds / 2, step_s=_STEP_S):
        answered = sum(response is not None for response in exchange.responses)
        if answered >= len(requests) * _WORTHWHILE:  # else the other half of the time would not do either
            context.wait_until(exchange.done, load.seconds / 2, step_s=_STEP_S)
    return exchange.responses
