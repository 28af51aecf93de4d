"""A request on its way, whoever spins the node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.task import Future
from std_srvs.srv import Trigger

from course_kit.ros.service import ServiceClient
from tests.ros.two_nodes import TwoNodes

if TYPE_CHECKING:
    from collections.abc import Iterator


class Pair(TwoNodes):
    """A client and its server, which leaves the first `forgotten` requests without an answer."""

    def __init__(self, domain_id: int) -> None:
        super().__init__(domain_id, ("server", "asking"))
        self.server, self.asking = self.nodes
        self.asked, self.forgotten = 0, 0
        self.server.create_service(AddTwoInts, "/ns/add", self.add, callback_group=ReentrantCallbackGroup())
        self.client = ServiceClient(self.asking, AddTwoInts, "ns/add")
        self.spin_until(self.client.is_ready)

    async def add(self, request: Any, response: Any) -> Any:
        self.asked += 1
        if self.asked <= self.forgotten:
            await Future()
        response.sum = request.a + request.b
        return response


@pytest.fixture
def pair(domain: int) -> Iterator[Pair]:
    made = Pair(domain)
    yield made
    made.close()


def test_a_request_is_answered(pair: Pair) -> None:
    sent = pair.client.send(AddTwoInts.Request(a=1, b=2))
    assert (sent.is_answered(), sent.response()) == (False, None)
    pair.spin_until(sent.is_answered)
    assert (sent.response().sum, pair.asked, pair.client.name) == (3, 1, "/ns/add")


def test_a_request_without_an_answer_is_sent_once_more(pair: Pair) -> None:
    pair.forgotten = 1
    sent = pair.client.send(AddTwoInts.Request(a=2, b=2))
    pair.spin_until(lambda: pair.asked == 1)
    pair.spin_until(lambda: sent.is_answered(0.0))
    assert (sent.response().sum, pair.asked) == (4, 2)


def test_a_request_of_another_service_is_refused(pair: Pair) -> None:
    with pytest.raises(TypeError):
        pair.client.send(Trigger.Request())
