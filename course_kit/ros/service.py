"""A client of one service: what is sent to it, and what comes back.

Nothing here waits: whoever calls spins, awaits, or looks now and then whether a response has come.
"""

from __future__ import annotations

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
    """A request on its way; sent again, the first response to any of its sendings counts."""

    def __init__(self, client: ServiceClient, request: Message) -> None:
        self._client, self._request = client, request
        self._futures: list[Future] = []
        self.send_again()

    @property
    def times_sent(self) -> int:
        """How often it was sent."""
        return len(self._futures)

    def send_again(self) -> None:
        """Send the same once more."""
        self._futures.append(self._client.rclpy_client.call_async(self._request))

    def is_answered(self) -> bool:
        """Whether a response has come, or a failure to give one."""
        return any(future.done() for future in self._futures)

    def response(self) -> Message:
        """The response; None until it comes."""
        done = next((future for future in self._futures if future.done()), None)
        if done is None:
            return None
        if error := done.exception():
            raise error
        return done.result()
