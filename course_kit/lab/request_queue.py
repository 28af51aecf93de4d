"""Requests wait here for their turn: a service, and a client, keeps the newest 10 that it has not taken, and no more.

ROS 2 drops the others and tells nobody. So of the calls that a notebook makes at once to one service, so many are on
their way, and the others follow in their order.
"""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING

from rclpy.qos import qos_profile_services_default

from course_kit.ros.service import ServiceClient

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node

    from course_kit.ros.messages import ServiceType

AT_ONCE: int = qos_profile_services_default.depth


class RequestQueue:
    """Lets so many requests be on their way at once; used from any thread."""

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._under_way: set[object] = set()
        self._waiting: deque[tuple[object, Callable[[], None]]] = deque()

    def enter(self, request: object, send: Callable[[], None]) -> None:
        """Send a request now, or as soon as another one has left."""
        with self._changing:
            if len(self._under_way) >= AT_ONCE:
                self._waiting.append((request, send))
                return
            self._under_way.add(request)
        send()

    def leave(self, request: object) -> None:
        """The request is answered, or nobody waits for it any more; harmless if it has left already."""
        with self._changing:
            if request not in self._under_way:
                self._waiting = deque(one for one in self._waiting if one[0] is not request)
                return
            self._under_way.discard(request)
            follower = self._waiting.popleft() if self._waiting else None
            if follower is not None:
                self._under_way.add(follower[0])
        if follower is not None:
            follower[1]()


class QueuedClient(ServiceClient):
    """A client of one service, with the queue of those who use it."""

    def __init__(self, node: Node, service_type: ServiceType, service: str) -> None:
        super().__init__(node, service_type, service)
        self.queue = RequestQueue()
