"""What comes for the grader reaches whom it is for, and nobody is passed over."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

from course_kit.grading.checks import grader_node as graders
from course_kit.grading.checks.hangs import CallBatch

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


CLIENTS, CALLS = 10, 50
STEPS_S = (0.004, 0.005, 0.006)  # no two in a row the same
PATIENCE_S = 200.0  # against hanging only


@pytest.fixture
def peer(domain: int) -> Iterator[Any]:
    """A node that answers when `turn` lets it."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    executor = SingleThreadedExecutor(context=context)
    node = rclpy.create_node("peer", context=context)
    executor.add_node(node)
    yield node
    executor.shutdown(timeout_sec=0)
    node.destroy_node()
    rclpy.shutdown(context=context)


@pytest.fixture
def grader_node(domain: int) -> Iterator[graders.GraderNode]:
    made = graders.GraderNode(domain)
    yield made
    made.close()


def turn(peer: Any, grader_node: graders.GraderNode, done: Callable[[], object]) -> None:
    """Let both do their work until it is done."""
    deadline, number = time.monotonic() + PATIENCE_S, 0
    while not done():
        assert time.monotonic() < deadline
        grader_node.spin_once(STEPS_S[number % len(STEPS_S)])
        number += 1
        for _ in range(CLIENTS):
            peer.executor.spin_once(timeout_sec=0)


def add(request: Any, response: Any) -> Any:
    response.sum = request.a + request.b
    return response


def test_each_of_many_clients_gets_its_own_responses(peer: Any, grader_node: graders.GraderNode) -> None:
    peer.create_service(AddTwoInts, "/add", add)
    clients = [grader_node.client(AddTwoInts, "/add", number) for number in range(CLIENTS)]
    turn(peer, grader_node, lambda: all(client.is_ready() for client in clients))
    for client in clients:  # from then on the server knows them, and loses nothing
        known = client.send(AddTwoInts.Request())
        turn(peer, grader_node, known.is_answered)
    batch = CallBatch(clients, [AddTwoInts.Request(a=number, b=1000) for number in range(CALLS)])
    turn(peer, grader_node, batch.exchange)
    assert [response.sum for response in batch.responses] == [number + 1000 for number in range(CALLS)]


def test_a_message_comes_with_its_times(peer: Any, grader_node: graders.GraderNode) -> None:
    heard = grader_node.inbox(String, "/chatter")
    publisher = peer.create_publisher(String, "/chatter", 10)
    turn(peer, grader_node, lambda: publisher.get_subscription_count() and grader_node.ends("publisher", "/chatter"))
    before = time.time()
    publisher.publish(String(data="hello"))
    turn(peer, grader_node, lambda: bool(heard.messages))
    assert [message.data for message in heard.messages] == ["hello"]
    assert before <= heard.times[0] <= time.time()


def test_what_the_grader_has_beside_its_endpoints_is_not_on_the_graph(
    peer: Any, grader_node: graders.GraderNode
) -> None:
    turn(peer, grader_node, lambda: "/peer" in grader_node.nodes() and len(peer.get_node_names()) > 1)
    grader = next(name for name in peer.get_node_names() if name != "peer")
    assert peer.get_service_names_and_types_by_node(grader, "/") == []
