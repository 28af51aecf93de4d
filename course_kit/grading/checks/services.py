"""What graders ask of a service server: is it there, does it answer, and if not, why not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading.checks import discovery
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import SubmissionEndedError
from course_kit.grading.checks.discovery import Wanted, await_offer, ensure_running
from course_kit.grading.checks.retry import RESEND_AFTER_S, RetriedRequest, wait_for_match
from course_kit.grading.diagnosis import hangs
from course_kit.grading.exchange_log import in_one_line

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message, ServiceType
    from course_kit.ros.service import ServiceClient

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
    interface: ServiceType
    type: str


@dataclass(frozen=True)
class Answer:
    """A response and how long it took, in seconds, fairly counted."""

    response: Message
    latency_s: float


def expect_offered(context: CheckContext, service: Service, request: Message) -> Evidence:
    """The service is on the graph, with its type, and its program is there to be asked.

    Args:
        context: the context of the check.
        service: what is expected.
        request: any request; whether and how it is answered is for other checks. It tells a server from a
            program that offers a service and ends at once, however fast each is discovered.

    Raises:
        Failed: it is not; with start.*, name.service, type.interface or limit.*.
    """
    expected = f"the service {service.name} of type {service.type}"
    client = _client(context, service)
    await_offer(context, _wanted(service), client.is_ready, context.grader_node.services)
    try:
        wait_for_match(context, client, request)
    except SubmissionEndedError as ended:
        if ended.diagnosis == "start.exit":
            evidence = Evidence("", expected, "a program that has ended")
            raise Failed(evidence, ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def expect_node(context: CheckContext, name: str, service: Service) -> Evidence:
    """A node of this full name is on the graph, beside the service.

    Args:
        context: the check's.
        name: the node's full name.
        service: the service it is to offer.

    Raises:
        Failed: it is not; with name.node.
    """
    return discovery.expect_node(context, name, lambda: ensure_ready(context, service))


def ensure_ready(context: CheckContext, service: Service) -> None:
    """Have a running submission that offers the service: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up a second time.
    """
    ensure_running(context, _wanted(service), lambda: _client(context, service).is_ready())


def call(context: CheckContext, service: Service, request: Message, shown: str, expected: str) -> Answer:
    """Send one request and wait for its answer.

    Args:
        context: the context of the check.
        service: whom to call.
        request: what to send.
        shown: the request as the learner is shown it.
        expected: what a right answer is, in words.

    Raises:
        Failed: none came; with the reason if it can be established.
    """
    ensure_ready(context, service)
    context.require_time(Evidence(shown, expected))
    turn = context.record.sent(f"request {service.name}: {in_one_line(request)}", about=shown)
    asked = RetriedRequest(context, request, _client(context, service), lambda: _client(context, service, 1))
    clock = asked.clock
    looked = False

    def decided() -> bool:
        nonlocal looked
        if asked.answered():
            return True
        if not looked and clock.wall() > _STUCK_S and clock.past(_STUCK_S):
            looked = True
            return hangs.doing(context).waits_for_ros
        return False

    try:
        context.wait_until(decided, hangs.ANSWER_S)
    except SubmissionEndedError as ended:
        evidence = Evidence(shown, expected, "no answer: the program ended")
        raise Failed(evidence, ended.message, ended.diagnosis) from None
    if (response := asked.response()) is not None:
        turn.came(f"response: {in_one_line(response)}")
        return Answer(response, clock.fair() if clock.wall() > RESEND_AFTER_S else clock.wall())
    raise hangs.unanswered(context, shown, expected, clock.fair())


def _client(context: CheckContext, service: Service, number: int = 0) -> ServiceClient:
    return context.grader_node.client(service.interface, service.name, number)


def _wanted(service: Service) -> Wanted:
    return Wanted("service", service.name, service.type)
