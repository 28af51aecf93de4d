"""What graders ask of a service server: does it answer, and if not, why not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from course_kit.grading.checks.check import Evidence
from course_kit.grading.checks.discovery import Server, ensure_ready
from course_kit.grading.checks.retry import RESEND_AFTER_S, RetriedRequest, wait_for_match
from course_kit.grading.diagnosis import exits, hangs
from course_kit.grading.diagnosis.exceptions import explained
from course_kit.grading.exchange_log import in_one_line
from course_kit.ros.messages import ServiceType

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.grader_node import GraderNode, Offer
    from course_kit.ros.messages import Message
    from course_kit.ros.service import ServiceClient

_STUCK_S = 3.0  # a callback seen waiting in rclpy for so long waits for itself


@dataclass(frozen=True)
class Service(Server[ServiceType]):
    """A service as the exercise names it."""

    kind: ClassVar[str] = "service"

    def client(self, node: GraderNode, number: int = 0) -> ServiceClient:
        """The grader's client `number`."""
        return node.client(self.interface, self.name, number)

    def ready(self, node: GraderNode) -> bool:
        """See `Server`."""
        return self.client(node).is_ready()

    def offers(self, node: GraderNode) -> list[Offer]:
        """See `Server`."""
        return node.services()

    def meet(self, context: CheckContext, request: Message) -> None:
        """See `Server`."""
        if request is not None:
            wait_for_match(context, self.client(context.grader_node), request)


@dataclass(frozen=True)
class TimedResponse:
    """A response and how long it took, in seconds, fairly counted."""

    response: Message
    latency_s: float


def call(context: CheckContext, service: Service, request: Message, shown: str, expected: str) -> TimedResponse:
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
    node = context.grader_node
    asked = RetriedRequest(context, request, service.client(node), lambda: service.client(node, 1))
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

    with explained(context, Evidence(shown, expected), exits.of_call, "no answer: the program ended"):
        context.wait_until(decided, hangs.ANSWER_S)
    if (response := asked.response()) is not None:
        turn.came(f"response: {in_one_line(response)}")
        return TimedResponse(response, clock.fair() if clock.wall() > RESEND_AFTER_S else clock.wall())
    raise hangs.unanswered(context, shown, expected, clock.fair())
