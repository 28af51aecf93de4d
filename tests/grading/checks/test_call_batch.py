"""Many calls at once: a lost first response is made good, a forgotten request is not."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future

from course_kit import environment
from course_kit.grading.checks.hangs import CallBatch
from course_kit.ros.service import ServiceClient

if TYPE_CHECKING:
    from collections.abc import Iterator

CLIENTS, CALLS = 4, 20
PATIENCE_S = 200.0  # against hanging only


class Forgetful:
    """A server that never answers the first request of a certain number."""

    def __init__(self, node: Any, number: int) -> None:
        self.asked: list[int] = []
        self._number = number
        node.create_service(AddTwoInts, "/add", self._answer, callback_group=ReentrantCallbackGroup())

    async def _answer(self, request: Any, response: Any) -> Any:
        self.asked.append(request.a)
        if request.a == self._number and self.asked.count(request.a) == 1:
            await Future()
        response.sum = request.a + request.b
        return response


@pytest.fixture
def executor() -> Iterator[SingleThreadedExecutor]:
    with environment.exclusive_domain() as domain_id:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain_id)
        spinning = SingleThreadedExecutor(context=context)
        for name in ("server", "asker"):
            spinning.add_node(rclpy.create_node(name, context=context))
        yield spinning
        for node in spinning.get_nodes():
            node.destroy_node()
        rclpy.shutdown(context=context)


def batchd(executor: SingleThreadedExecutor, number: int) -> tuple[CallBatch, Forgetful]:
    """An batch with a server that forgets this request, as far as it goes without waiting for nothing."""
    server, asker = executor.get_nodes()
    forgetful = Forgetful(server, number)
    clients = [ServiceClient(asker, AddTwoInts, "/add") for _ in range(CLIENTS)]
    for client in clients:
        while not client.is_ready():
            executor.spin_once(timeout_sec=0.05)
    requests = [AddTwoInts.Request(a=each, b=1) for each in range(CALLS)]
    batch = CallBatch(clients, requests)
    deadline = time.monotonic() + PATIENCE_S
    while not batch.exchange() and not settled(batch, forgetful):
        assert time.monotonic() < deadline
        executor.spin_once(timeout_sec=0.05)
    return batch, forgetful


def settled(batch: CallBatch, server: Forgetful) -> bool:
    """Whether a first request was sent again for the one that is missing, or it is none that ever would be."""
    missing = [number for number, response in enumerate(batch.responses) if response is None]
    return len(missing) == 1 and missing[0] >= CLIENTS and server.asked.count(missing[0]) == 1


def test_a_clients_first_request_is_sent_again_when_its_response_is_lost(executor: SingleThreadedExecutor) -> None:
    batch, server = batchd(executor, CLIENTS - 1)
    assert [response.sum for response in batch.responses] == [number + 1 for number in range(CALLS)]
    assert server.asked.count(CLIENTS - 1) == 2


def test_a_later_one_is_not(executor: SingleThreadedExecutor) -> None:
    batch, server = batchd(executor, CALLS - 1)
    assert batch.responses[CALLS - 1] is None
    batch._moved -= 60.0  # as if nothing had come for a minute
    assert not batch.exchange()
    # What the same client sends afterwards comes afterwards.
    batch._clients[(CALLS - 1) % CLIENTS].send(AddTwoInts.Request(a=CALLS, b=1))
    deadline = time.monotonic() + PATIENCE_S
    while CALLS not in server.asked:
        assert time.monotonic() < deadline
        executor.spin_once(timeout_sec=0.05)
    assert server.asked.count(CALLS - 1) == 1
