"""Many calls at once: what a service does when more than one client asks."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from course_kit.grading import processes
from course_kit.grading.bench import SubmissionEndedError
from course_kit.grading.checks import Evidence, Failed
from course_kit.grading.services import Service, ensure_ready
from course_kit.grading.silence import unanswered

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.bench import Bench

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


def call_many(bench: Bench, service: Service, requests: Sequence[Any], load: Load, evidence: Evidence) -> list[Any]:
    """Send all requests and return the responses in their order.

    Raises:
        Failed: not all were answered in time, with service.blocks when they came one by one but too slowly.
    """
    ensure_ready(bench, service)
    clients = [bench.tester.client(service.interface, service.name, number) for number in range(load.clients)]
    try:
        bench.wait_until(lambda: all(client.service_is_ready() for client in clients), load.seconds)
        turn = bench.record.sent(evidence.sent)
        late = _Lateness()
        clock = bench.clock(late.seconds)
        responses = _run(bench, clients, requests, load, late)
        spent = clock.fair()
    except SubmissionEndedError as ended:
        raise Failed(replace(evidence, got="the program ended"), ended.message, ended.diagnosis) from None
    answered = sum(response is not None for response in responses)
    if answered:
        turn.came(f"{answered} of {len(requests)} responses within {spent:.1f} s")
    if answered == len(requests) and spent <= load.seconds:
        return responses
    bench.spoil()
    if answered == 0:
        raise unanswered(bench, evidence.sent, evidence.expected)
    each = spent / answered
    message = (
        f"{answered} of {len(requests)} requests were answered in {spent:.1f} s, one in {each:.2f} s: "
        f"the last of {load.clients} clients asking together waits {load.clients * each:.1f} s."
    )
    raise Failed(replace(evidence, got=f"{answered} answers in {spent:.1f} s"), message, "service.blocks")


class _Lateness:
    """By how much the grader may have been late, on a loaded machine, in seeing what had come.

    An answer that is found had come since the last look; it lay there for no longer than the time between the two.
    Time between looks that find nothing was not lost: nothing was there.
    """

    def __init__(self) -> None:
        self._looked = time.monotonic()
        self._late = 0.0
        self._before = processes.own_waiting(helpers_only=True)

    def look(self, *, found: bool) -> None:
        """Take note of a look, and of whether it found anything."""
        now = time.monotonic()
        if found:
            self._late += now - self._looked
        self._looked = now

    def seconds(self) -> float:
        """The lateness so far; that of the threads which bring the answers included."""
        return max(self._late, processes.own_waiting(helpers_only=True) - self._before)


def _run(bench: Bench, clients: Sequence[Any], requests: Sequence[Any], load: Load, late: _Lateness) -> list[Any]:
    responses: list[Any] = [None] * len(requests)
    waiting = deque(enumerate(requests))
    flying: dict[int, Any] = {}

    def done() -> bool:
        ready = [number for number, future in flying.items() if future.done()]
        late.look(found=bool(ready))
        for number in ready:
            responses[number] = flying.pop(number).result()
        while waiting and len(flying) < load.unanswered:
            number, request = waiting.popleft()
            flying[number] = clients[number % len(clients)].call_async(request)
        return not flying

    if not bench.wait_until(done, load.seconds / 2):
        answered = sum(response is not None for response in responses)
        if answered >= len(requests) * _WORTHWHILE:  # else the other half of the time would not do either
            bench.wait_until(done, load.seconds / 2)
    return responses
