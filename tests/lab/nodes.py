"""Nodes a learner might write, for the tests of the lab."""

from __future__ import annotations

import threading
from typing import Any

import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger


class Switch(Node):
    """Serves /switch; which of its instances answered is told by `label`."""

    def __init__(self, name: str = "switch", label: str = "first") -> None:
        super().__init__(name)
        self.label = label
        self.answers = 0
        self.ok: bool | None = None
        self.create_service(SetBool, "switch", self.answer)

    def answer(self, request: Any, response: Any) -> Any:
        self.answers += 1
        self.ok = rclpy.ok()
        response.success = request.data
        response.message = self.label
        return response


class Faulty(Node):
    """Serves one service for each way to get it wrong."""

    def __init__(self) -> None:
        super().__init__("faulty")
        self.release = threading.Event()
        self.client = self.create_client(Trigger, "fine")
        for name in ("raises", "forgets", "returns_number", "returns_request", "exits", "blocks", "calls", "spins"):
            self.create_service(Trigger, name, getattr(self, name))
        self.create_service(Trigger, "waits", self.waits)
        self.create_service(Trigger, "fine", self.fine)

    def fine(self, _request: Any, response: Any) -> Any:
        response.success = True
        return response

    def raises(self, _request: Any, _response: Any) -> Any:
        message = "the sensor is unplugged"
        raise RuntimeError(message)

    def forgets(self, _request: Any, response: Any) -> None:
        response.success = True

    def returns_number(self, _request: Any, _response: Any) -> Any:
        return 42

    def returns_request(self, request: Any, _response: Any) -> Any:
        return request

    def exits(self, _request: Any, _response: Any) -> Any:
        raise SystemExit(3)

    def blocks(self, _request: Any, response: Any) -> Any:
        self.release.wait(20)
        return response

    def calls(self, _request: Any, _response: Any) -> Any:
        return self.client.call(Trigger.Request())

    def spins(self, _request: Any, response: Any) -> Any:
        rclpy.spin_until_future_complete(self, self.client.call_async(Trigger.Request()))
        return response

    async def waits(self, _request: Any, response: Any) -> Any:
        await self.client.call_async(Trigger.Request())
        return response


class SpeechlessError(Exception):
    """Cannot say what it is."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


class OwnBaseError(BaseException):
    """What `except Exception` lets pass."""


class Raising(Node):
    """Serves /fails and has a timer that fails once, with the same error.

    Args:
        error: the class of what is raised.
    """

    def __init__(self, error: type[BaseException]) -> None:
        super().__init__("raising")
        self.error = error
        self.ticked = threading.Event()
        self.create_service(Trigger, "fails", self.fails)
        self.create_service(Trigger, "fails_later", self.fails_later)
        self.ticking = self.create_timer(0.01, self.tick)

    def fails(self, _request: Any, _response: Any) -> Any:
        raise self.error

    async def fails_later(self, _request: Any, _response: Any) -> Any:
        raise self.error

    def tick(self) -> None:
        self.ticking.cancel()
        self.ticked.set()
        raise self.error


class Talker(Node):
    """Counts aloud on /count."""

    def __init__(self) -> None:
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "count", 10)
        self.number = 0
        self.create_timer(0.01, self.tick)

    def tick(self) -> None:
        self.number += 1
        self.publisher.publish(String(data=str(self.number)))
