"""What graders ask of a service server: is it there, does it answer, and if not, why not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks import discovery
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import SubmissionEndedError
from course_kit.grading.checks.discovery import Wanted, await_offer, ensure_running
from course_kit.grading.checks.retry import NUDGE_S, Asked, get_known
from course_kit.grading.diagnosis import hangs
from course_kit.grading.exchange_log import tell

if TYPE_CHECKING:
    from rclpy.client import Client

    from course_kit.grading.checks.context import Bench

_STUCK_S = 3.0  # a callback seen waiting in rclpy for so long waits for itself


@dataclass(frozen=True)
class Service:
    """A service as the exercise names it.

    Attributes:
        name: its full name.
        interface: its class.
        type: the interface's name, `package/srv/Name`.
    """

    name: str
    interface: Any
    type: str


@dataclass(frozen=True)
class Answer:
    """A response and how long it took, in seconds, fairly counted."""

    response: Any
    latency_s: float


def expect_offered(bench: Bench, service: Service, request: Any) -> Evidence:
    """The service is on the graph, with its type, and its program is there to be asked.

    Args:
        bench: the test bench.
        service: what is expected.
        request: any request; whether and how it is answered is for other checks. It tells a server from a
            program that offers a service and ends at once, however fast each is discovered.

    Raises:
        Failed: it is not; with start.*, name.service, type.interface or limit.*.
    """
    expected = f"the service {service.name} of type {service.type}"
    client = _client(bench, service)
    await_offer(bench, _wanted(service), client.service_is_ready, bench.tester.services)
    try:
        get_known(bench, client, request)
    except SubmissionEndedError as ended:
        if ended.diagnosis == "start.exit":
            evidence = Evidence("", expected, "a program that has ended")
            raise Failed(evidence, ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def expect_node(bench: Bench, name: str, service: Service) -> Evidence:
    """A node of this full name is on the graph, beside the service.

    Raises:
        Failed: it is not; with name.node.
    """
    return discovery.expect_node(bench, name, lambda: ensure_ready(bench, service))


def ensure_ready(bench: Bench, service: Service) -> None:
    """Have a running submission that offers the service: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up a second time.
    """
    ensure_running(bench, _wanted(service), lambda: _client(bench, service).service_is_ready())


def call(bench: Bench, service: Service, request: Any, shown: str, expected: str) -> Answer:
    """Send one request and wait for its answer.

    Args:
        bench: the test bench.
        service: whom to call.
        request: what to send.
        shown: the request as the learner is shown it.
        expected: what a right answer is, in words.

    Raises:
        Failed: none came; with the reason if it can be established.
    """
    ensure_ready(bench, service)
    bench.require_time(Evidence(shown, expected))
    turn = bench.record.sent(f"request {service.name}: {tell(request)}", about=shown)
    asked = Asked(bench, request, _client(bench, service), lambda: _client(bench, service, 1))
    clock = asked.clock
    looked = False

    def decided() -> bool:
        nonlocal looked
        if asked.answered():
            return True
        if not looked and clock.wall() > _STUCK_S and clock.past(_STUCK_S):
            looked = True
            return hangs.doing(bench).waits_for_ros
        return False

    try:
        bench.wait_until(decided, hangs.ANSWER_S)
    except SubmissionEndedError as ended:
        evidence = Evidence(shown, expected, "no answer: the program ended")
        raise Failed(evidence, ended.message, ended.diagnosis) from None
    if (response := asked.response()) is not None:
        turn.came(f"response: {tell(response)}")
        return Answer(response, clock.fair() if clock.wall() > NUDGE_S else clock.wall())
    raise hangs.unanswered(bench, shown, expected, clock.fair())


def _client(bench: Bench, service: Service, number: int = 0) -> Client:
    return bench.tester.client(service.interface, service.name, number)


def _wanted(service: Service) -> Wanted:
    return Wanted("service", service.name, service.type)
