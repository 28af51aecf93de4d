"""Takes in what comes for the grader's clients and subscriptions.

An rclpy executor does it as well, at about five times the computing: it makes a timer, a wait set and a task for each
turn, and a grading is a thousand turns. With ten clients of one service each of them is woken by every response.
"""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING, TypeAlias

from rclpy.executors import SingleThreadedExecutor, TimeoutException
from rclpy.impl.implementation_singleton import rclpy_implementation

from course_kit.ros import compat

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.subscription import Subscription

    from course_kit.ros.messages import Message
    from course_kit.ros.service import ServiceClient
    from course_kit.ros.topic import MessageInfo

Take: TypeAlias = "Callable[[Message, MessageInfo], None]"
_STEP_S = 0.005


def receiver(node: Node) -> WaitSetReceiver | ExecutorReceiver:
    """The fast one where rclpy lets itself be used that way, else one that is an executor of rclpy's."""
    fast = compat.check_features([compat.FAST_GRADING]).has(compat.FAST_GRADING)
    return WaitSetReceiver(node) if fast else ExecutorReceiver(node)


class ExecutorReceiver:
    """Receives for the clients and subscriptions of a node, by an executor of rclpy's; for use by one thread."""

    def __init__(self, node: Node) -> None:
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)

    def add_client(self, client: ServiceClient) -> None:
        """Receive the responses of a client; an executor knows it from its node."""

    def add_subscription(self, subscription: Subscription, take: Take) -> None:
        """Receive the messages of a subscription; an executor knows it from its node.

        Args:
            subscription: whose messages.
            take: its callback, which gets each, and rclpy's facts about it.
        """

    def receive(self, timeout_s: float) -> None:
        """Take in what has come, after waiting at most `timeout_s` seconds for any."""
        deadline = time.monotonic() + timeout_s
        while not self._take_one() and time.monotonic() < deadline:
            pass

    def _take_one(self) -> bool:
        """Wait a moment for one message, and take it in; whether there was one."""
        try:
            # Always for the same time: with another one the executor begins anew, and the last are never reached.
            handler, _, _ = self._executor.wait_for_ready_callbacks(timeout_sec=_STEP_S)
        except TimeoutException:
            return False
        handler()
        handler.result()  # raises what it has raised
        return True

    def close(self) -> None:
        """Receive nothing any more; the node is still there."""
        self._executor.shutdown(timeout_sec=0)


class WaitSetReceiver:
    """The same by a wait set of its own."""

    def __init__(self, node: Node) -> None:
        context = self._context = node.context
        self._clients: dict[
            int, ServiceClient
        ] = {}  # by the address of the handle, as the wait set names what is ready
        self._subscriptions: dict[int, tuple[Subscription, Take]] = {}
        self._nothing = rclpy_implementation.GuardCondition(context.handle)  # a wait set must not be empty
        self._wait_set: rclpy_implementation.WaitSet | None = None

    def add_client(self, client: ServiceClient) -> None:
        """See `ExecutorReceiver`."""
        self._clients[client.rclpy_client.handle.pointer] = client
        self._wait_set = None

    def add_subscription(self, subscription: Subscription, take: Take) -> None:
        """See `ExecutorReceiver`."""
        self._subscriptions[subscription.handle.pointer] = (subscription, take)
        self._wait_set = None

    def receive(self, timeout_s: float) -> None:
        """Take in at most one message for each, after waiting at most `timeout_s` seconds for any."""
        ready = self._wait(timeout_s)
        for pointer in ready.get_ready_entities("subscription"):
            subscription, take = self._subscriptions[pointer]
            taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
            if taken is not None:
                take(*taken)
        for pointer in ready.get_ready_entities("client"):
            client, service_type = self._clients[pointer].rclpy_client, self._clients[pointer].type
            header, response = client.handle.take_response(service_type.Response)
            if header is not None:  # else the response was for another client of the same service
                with suppress(KeyError):  # a second answer to the same request
                    client.get_pending_request(header.request_id.sequence_number).set_result(response)

    def close(self) -> None:
        """See `ExecutorReceiver`; it has nothing of its own on the node."""

    def _wait(self, timeout_s: float) -> rclpy_implementation.WaitSet:
        if self._wait_set is None:
            self._wait_set = rclpy_implementation.WaitSet(
                len(self._subscriptions), 1, 0, len(self._clients), 0, 0, self._context.handle
            )
        wait_set = self._wait_set
        wait_set.clear_entities()
        wait_set.add_guard_condition(self._nothing)
        for subscription, _ in self._subscriptions.values():
            wait_set.add_subscription(subscription.handle)
        for client in self._clients.values():
            wait_set.add_client(client.rclpy_client.handle)
        wait_set.wait(int(timeout_s * 1e9))
        return wait_set
