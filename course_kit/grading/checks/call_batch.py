"""Many calls at once: what a service does when more than one client asks."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.hangs import RESEND_AFTER_S, explain_end, explain_no_answer
from course_kit.grading.diagnosis import exits
from course_kit.grading.model.bounds import bound_message

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message
    from course_kit.ros.service import SentRequest, ServiceClient

_STEP_S = 0.004  # how often it is looked: what lies between two looks counts as the grader's lateness
_WORTHWHILE = 0.4  # of the requests answered when half the time is over


def call_many(
    context: CheckContext,
    clients: Sequence[ServiceClient],
    requests: Sequence[Message],
    within_s: float,
    seen: Evidence,
) -> list[Message]:
    """Send all requests, one of each client at a time, and return the responses in their order."""
    with explain_end(context, seen, exits.explain_call):
        context.wait_until(lambda: all(client.is_ready() for client in clients), within_s, step_s=_STEP_S)
        turn = context.record.add_sent(seen.sent)
        batch = CallBatch(clients, requests)
        clock = context.clock(batch.lateness)
        for _ in range(2):
            done = context.wait_until(batch.exchange, within_s / 2, step_s=_STEP_S)
            if done or batch.answered < len(requests) * _WORTHWHILE:  # the other half of the time would not do either
                break
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
        f"{answered} of {len(requests)} requests were answered in {spent:.1f} s, one in {each:.2f} s: "
        f"the last of {len(clients)} clients that ask together waits {len(clients) * each:.1f} s."
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
            self.responses[number] = bound_message(self._flying.pop(number).response())
            self._late[number % len(self._late)] += now - self._looked
            self._moved = now
        self._looked = now
        while self._waiting and len(self._flying) < len(self._clients):
            number = self._waiting.popleft()
            self._flying[number] = self._clients[number % len(self._clients)].send(self._requests[number])
        if now - self._moved > RESEND_AFTER_S:
            self._send_first_ones_again()
        return not self._flying

    def _send_first_ones_again(self) -> None:
        """Once: the middleware drops a response while the server has not noticed the client, on a loaded machine."""
        for number, sent in self._flying.items():
            if number < len(self._clients) and sent.times_sent == 1:
                sent.send_again()
