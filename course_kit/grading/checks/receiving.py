"""Takes in what comes for the grader's clients and subscriptions.

An rclpy executor does it as well, at about five times the computing: it makes a timer, a wait set and a task for each
turn, and a grading is a thousand turns. With ten clients of one service each of them is woken by every response.
"""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol

from rclpy.executors import SingleThreadedExecutor, TimeoutException

from course_kit.ros import compat, compat_names

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.client import Client
    from rclpy.node import Node
    from rclpy.subscription import Subscription

_STEP_S = 0.005


class Receiver(Protocol):
    """Receives for the clients and subscriptions of a node; for use by one thread."""

    def add_client(self, client: Client) -> None:
        """Receive the responses of a client."""

    def add_subscription(self, subscription: Subscription, take: Callable[[Any, Any], None]) -> None:
        """Receive the messages of a subscription; `take`, its callback, gets each, and rclpy's facts about it."""

    def receive(self, timeout_s: float) -> None:
        """Take in what has come, after waiting at most `timeout_s` seconds for any."""

    def close(self) -> None:
        """Receive nothing any more; the node is still there."""


def receiver(node: Node) -> Receiver:
    """The fast one where rclpy lets itself be used that way, else one that is an executor of rclpy's."""
    fast = compat.check([compat_names.FAST_GRADING]).has(compat_names.FAST_GRADING)
    return WaitSetReceiver(node) if fast else ExecutorReceiver(node)


class ExecutorReceiver:
    """Receives by an executor of rclpy's, which takes in one message at a time."""

    def __init__(self, node: Node) -> None:
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)

    def add_client(self, client: Client) -> None:
        """See `Receiver`; the executor knows it from its node."""

    def add_subscription(self, subscription: Subscription, take: Callable[[Any, Any], None]) -> None:
        """See `Receiver`; the executor knows it from its node, and calls `take` as its callback."""

    def receive(self, timeout_s: float) -> None:
        """See `Receiver`."""
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
        """See `Receiver`."""
        self._executor.shutdown(timeout_sec=0)


class WaitSetReceiver:
    """Receives by a wait set of its own."""

    def __init__(self, node: Node) -> None:
        from rclpy.impl.implementation_singleton import rclpy_implementation

        self._rclpy: Any = rclpy_implementation
        context = self._context = node.context
        self._clients: dict[int, Client] = {}  # by the address of the handle, as the wait set names what is ready
        self._subscriptions: dict[int, tuple[Subscription, Callable[[Any, Any], None]]] = {}
        self._nothing = self._rclpy.GuardCondition(context.handle)  # a wait set must not be empty
        self._wait_set: Any = None

    def add_client(self, client: Client) -> None:
        """See `Receiver`."""
        self._clients[client.handle.pointer] = client
        self._wait_set = None

    def add_subscription(self, subscription: Subscription, take: Callable[[Any, Any], None]) -> None:
        """See `Receiver`."""
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
            client: Any = self._clients[pointer]  # the type of a service's class does not say that it has parts
            header, response = client.handle.take_response(client.srv_type.Response)
            if header is not None:  # else the response was for another client of the same service
                with suppress(KeyError):  # a second answer to the same request
                    client.get_pending_request(header.request_id.sequence_number).set_result(response)

    def close(self) -> None:
        """See `Receiver`."""

    def _wait(self, timeout_s: float) -> Any:
        if self._wait_set is None:
            self._wait_set = self._rclpy.WaitSet(
                len(self._subscriptions), 1, 0, len(self._clients), 0, 0, self._context.handle
            )
        wait_set = self._wait_set
        wait_set.clear_entities()
        wait_set.add_guard_condition(self._nothing)
        for subscription, _ in self._subscriptions.values():
            wait_set.add_subscription(subscription.handle)
        for client in self._clients.values():
            wait_set.add_client(client.handle)
        wait_set.wait(int(timeout_s * 1e9))
        return wait_set
