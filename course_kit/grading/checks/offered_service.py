"""A service of the grader, which a learner's node calls."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.answers import message_of
from course_kit.grading.checks.exchange_log import in_one_line
from course_kit.grading.model.bounds import bounded

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.graded_node import GradedNode
    from course_kit.ros.messages import Message, ServiceType

_MOST = 1000  # requests that are kept
_OFFERS = "offers"  # remembered as long as the submission runs


def offer_service(node: GradedNode, name: str, interface: ServiceType, **answer: Any) -> OfferedService:
    """Offer a service to the program, which calls it; one that is offered already gets another answer.

    Args:
        node: the program.
        name: the service's full name.
        interface: its class.
        answer: fields of the response that each request gets at once; without any, requests wait for `reply`.

    Example:
        >>> door = offer_service(node, "/open", SetBool)
        >>> node.goal("/deliver", room="attic")
        >>> node.context.wait_until(lambda: door.requests, 3.0)
        >>> door.reply(SetBool.Response(success=True))
    """
    offers: dict[str, OfferedService] = node.context.memory.setdefault(_OFFERS, {})
    if name not in offers:
        offers[name] = OfferedService(node.context, name, interface)
        node.context.grader_node.add_service(offers[name])
    offers[name].answer = message_of(interface.Response, None, answer) if answer else None
    return offers[name]


def withdraw_service(node: GradedNode, name: str) -> None:
    """Offer a service no more, as if its node had ended.

    Example:
        >>> withdraw_service(node, "/open")
    """
    node.context.grader_node.remove_service(node.context.memory[_OFFERS].pop(name))


class OfferedService:
    """A service of the grader, which a learner's node calls."""

    def __init__(self, context: CheckContext, name: str, interface: ServiceType) -> None:
        self._type, self._record = interface, context.record
        self.rclpy_service = context.grader_node.node.create_service(interface, name, lambda _, response: response)
        self.answer: Message | None = None  # that each request gets at once; while it is None they wait for `reply`
        self.requests: deque[Message] = deque(maxlen=_MOST)  # the last that have come
        self._waiting: deque[Any] = deque(maxlen=_MOST)  # the headers of requests without an answer

    def take(self) -> None:
        """Take one request in."""
        request, header = self.rclpy_service.handle.service_take_request(self._type.Request)
        if header is None:
            return
        self.requests.append(bounded(request))
        self._waiting.append(header)
        self._record.came(f"request {self.rclpy_service.srv_name}: {in_one_line(self.requests[-1])}", "request")
        if self.answer is not None:
            self.reply(self.answer)

    def reply(self, response: Message) -> None:
        """Answer every request that waits."""
        while self._waiting:
            self._record.sent(f"response: {in_one_line(response)}", "response")
            self.rclpy_service.send_response(response, self._waiting.popleft())
