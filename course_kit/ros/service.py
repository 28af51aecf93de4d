"""A client of one service: what is sent to it, and what comes back.

Nothing here waits: whoever calls spins, awaits, or looks now and then whether a response has come.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import InvalidHandle

from course_kit.ros.messages import type_name

if TYPE_CHECKING:
    from rclpy.client import Client
    from rclpy.node import Node
    from rclpy.task import Future

    from course_kit.ros.messages import Message, ServiceType


class ServiceClient:
    """A client of one service."""

    def __init__(self, node: Node, service_type: ServiceType, service: str) -> None:
        self._node = node
        # Reentrant: a response is taken in while another callback of the node waits for it.
        self.rclpy_client: Client = node.create_client(service_type, service, callback_group=ReentrantCallbackGroup())
        self.type, self.type_name = service_type, type_name(service_type)
        self.name = self.rclpy_client.service_name
        self.busy: set[object] = set()  # those who wait for a response, as far as they say so

    def is_ready(self) -> bool:
        """Whether a server is connected; never when the node has been destroyed."""
        try:
            return self.rclpy_client.service_is_ready()
        except InvalidHandle:
            return False

    def send(self, request: Message) -> SentRequest:
        """Send a request."""
        return SentRequest(self, request)

    def destroy(self) -> None:
        """Take it off the node."""
        self._node.destroy_client(self.rclpy_client)


class SentRequest:
    """A request on its way; sent once more, the first response to either counts."""

    def __init__(self, client: ServiceClient, request: Message) -> None:
        self._client, self._request, self._sent_at = client, request, time.monotonic()
        self._futures: list[Future] = []
        self._send()

    def _send(self) -> None:
        self._futures.append(self._client.rclpy_client.call_async(self._request))

    def is_answered(self, again_after_s: float | None = None) -> bool:
        """Whether a response has come, or a failure to give one; without any for so long it is sent once more."""
        answered = any(future.done() for future in self._futures)
        late = again_after_s is not None and time.monotonic() - self._sent_at > again_after_s
        if late and not answered and len(self._futures) == 1:
            self._send()
        return answered

    def response(self) -> Message:
        """The response; None until it comes."""
        return next((future.result() for future in self._futures if future.done()), None)
