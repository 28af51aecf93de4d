"""Calling a service: one piece of code, driven by asyncio in a notebook and by a wait in a program.

The lab has one hidden node for its own calls and keeps one client for each service it has called.
"""

from __future__ import annotations

import asyncio
import threading
import time
from abc import ABC, abstractmethod
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Literal

from rclpy.qos import qos_profile_services_default

from course_kit.lab.clients import WantedServer, not_found
from course_kit.lab.errors import FieldError, NoAnswerError, ServiceFailedError
from course_kit.ros.filling import make_message
from course_kit.ros.graph import SERVES, count_servers
from course_kit.ros.messages import BadFieldError, describe_type, is_message_type

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.task import Future

    from course_kit.lab.runtime.engine import Engine
    from course_kit.ros.filling import Fields
    from course_kit.ros.graph import Role
    from course_kit.ros.messages import ActionType, Message, ServiceType

_APPEARANCE = 2.0  # seconds a service is given to appear on the graph; discovery takes a tenth of that
_POLL = 0.005  # seconds between looks at the graph, which cost microseconds
_CHECK = 0.2  # seconds between looks at whether the server is still there
_AT_ONCE: int = qos_profile_services_default.depth


class PendingCall(ABC):
    """Something sent, and the wait for what comes back; `call_async` and `call_blocking` drive it."""

    def __init__(self, lab: Engine, wanted: WantedServer, timeout: float) -> None:
        self._lab = lab
        self._wanted = wanted
        self._timeout = timeout
        self._start = time.monotonic()

    def may_send(self) -> bool:
        if self._is_there():
            if not self._is_ours():
                self._lab.before_call(self._wanted.role, self._wanted.name)
            return True
        waited = min(_APPEARANCE, self._timeout)
        if time.monotonic() - self._start < waited:
            return False
        raise not_found(self._lab.node, self._wanted, waited, self._lab.own_names)

    @abstractmethod
    def send(self, completed: Callable[..., None]) -> None:
        """Send; `completed` is called on the lab's thread when the answer may be there."""

    def next_check(self) -> float:
        return max(0.0, min(_CHECK, self._start + self._timeout - time.monotonic()))

    def check(self) -> None:
        if self.has_come():
            return
        self._lab.output.drain()
        if time.monotonic() - self._start >= self._timeout:
            raise NoAnswerError(self._too_late())
        if self._is_gone():
            raise NoAnswerError(server_gone(self._lab, self._wanted.role, self._wanted.name))

    @abstractmethod
    def has_come(self) -> bool:
        """Whether the answer is there."""

    @abstractmethod
    def result(self) -> Any:
        """What came back."""

    def close(self) -> None:
        """Stop waiting, whether or not the answer has come."""
        self._lab.output.drain()

    @abstractmethod
    def _too_late(self) -> str:
        """What to say when the time is over."""

    def _is_gone(self) -> bool:
        """Whether the server has gone since."""
        return not self._is_there()

    @abstractmethod
    def _is_there(self) -> bool:
        """Whether the server is on the graph."""

    @abstractmethod
    def _is_ours(self) -> bool:
        """Whether a node of this lab is such a server."""


def server_gone(lab: Engine, role: Role, name: str) -> str:
    """What to say of a server that has gone with an answer, or a goal, on its way; one that is there knows no goal."""
    if (count := count_servers(lab.node, role.kind, name)) > 1:
        return f"{count} nodes have {name}, and one that does not know this goal answered. lab.stop_others() may help."
    return f"The server of {name} went away: its program ended or its node was stopped. Its own output says why."


class ServiceCall(PendingCall):
    """One request and the wait for its response."""

    def __init__(  # noqa: PLR0913, PLR0917 - a request, and where it goes
        self, lab: Engine, service: str, service_type: ServiceType, ready: Message, fields: Fields, timeout: float
    ) -> None:
        self._request = make_part(service_type, "Request", ready, fields)
        self._client = lab.clients.client(service_type, service)
        self._response: Future | None = None
        super().__init__(lab, WantedServer(SERVES, self._client.name, self._client.type_name), timeout)

    def may_send(self) -> bool:
        """Whether the server is there, and has room: of what waits for it, a service keeps the newest so many."""
        if len(self._client.busy) >= _AT_ONCE:
            self.check()
            return False
        return super().may_send()

    def send(self, completed: Callable[..., None]) -> None:
        self._client.busy.add(self)
        self._response = self._client.rclpy_client.call_async(self._request)
        self._response.add_done_callback(completed)

    def result(self) -> Message:
        try:
            return self._response.result() if self._response is not None else None
        except ServiceFailedError as error:
            raise ServiceFailedError(str(error)) from None  # a fresh one: an exception keeps the frames it passed

    def close(self) -> None:
        if self._response is not None and not self._response.done():
            self._response.cancel()
        self._client.busy.discard(self)
        super().close()

    def has_come(self) -> bool:
        return self._response is not None and bool(self._response.done())

    def _too_late(self) -> str:
        why = self._lab.why_no_answer(self._wanted.name)
        if self._response is None:
            return (
                f"{self._wanted.name} was not called within {self._timeout:g} s: {_AT_ONCE} earlier calls of this "
                f"notebook still wait for their answers. {why}"
            )
        return f"{self._wanted.name} did not answer within {self._timeout:g} s. {why}"

    def _is_there(self) -> bool:
        return self._client.is_ready()

    def _is_ours(self) -> bool:
        nodes = [node for live in self._lab.nodes.live for node in live.made]
        return any(service.service_name == self._wanted.name for node in nodes for service in node.services)


def make_waker() -> tuple[asyncio.Event, Callable[..., None]]:
    """An event of the running loop, and what sets it from any thread."""
    loop, news = asyncio.get_running_loop(), asyncio.Event()

    def wake(*_: object) -> None:
        with suppress(RuntimeError):  # the loop is closed: nobody waits
            loop.call_soon_threadsafe(news.set)

    return news, wake


async def call_async(call: PendingCall) -> Any:
    """Drive a call from asyncio; uses no time while it waits."""
    news, wake = make_waker()
    try:
        while not call.may_send():  # noqa: ASYNC110 - rclpy has no event for changes of the graph
            await asyncio.sleep(_POLL)
        call.send(wake)
        while not call.has_come():
            timer = asyncio.get_running_loop().call_later(call.next_check(), news.set)
            try:
                await news.wait()
            finally:
                timer.cancel()
            news.clear()
            call.check()
        return call.result()
    finally:
        call.close()


def call_blocking(call: PendingCall) -> Any:
    """Drive a call from a plain function, showing output now and then. Ctrl-C interrupts it."""
    pause = threading.Event()
    try:
        while not call.may_send():
            pause.wait(_POLL)
        call.send(lambda *_: pause.set())
        while not call.has_come():
            pause.wait(call.next_check())
            pause.clear()
            call.check()
        return call.result()
    finally:
        call.close()


# By the part of it that is sent: what a class is, which verb takes it, and all its parts.
_INTERFACES = {
    "Request": ("a service", "lab.call", ("_Request", "_Response")),
    "Goal": ("an action", "lab.send_goal", ("_Goal", "_Result", "_Feedback")),
}


def make_part(
    interface: ServiceType | ActionType, part: Literal["Request", "Goal"], ready: Message, fields: Fields
) -> Message:
    """The request of a service or the goal of an action to be sent; raises FieldError."""
    message_type = getattr(interface, part, None)
    if message_type is not None:
        return message_of(message_type, ready, fields)
    kind, verb, parts = _INTERFACES[part]
    hint = ""
    owner = getattr(interface, "__name__", "")
    if owner.endswith(parts):
        hint = f" Use {owner.rpartition('_')[0]} itself."
    elif not isinstance(interface, type):
        hint = f" The order is: {verb}(name, Type, field=value)."
    raise FieldError(f"{owner or repr(interface)} is not {kind} type.{hint}")


def require_message_type(given: object) -> None:
    """Refuse what is not a message's class."""
    if not is_message_type(given):
        raise FieldError(f"{getattr(given, '__name__', given)!r} is not a message type.")


def message_of(message_type: type[Message], ready: Message, fields: Fields) -> Message:
    """The message to be sent."""
    if ready is None:
        try:
            return make_message(message_type, fields)
        except BadFieldError as error:
            raise FieldError(str(error)) from error
    if fields or not isinstance(ready, message_type):
        raise FieldError(f"Pass either {describe_type(message_type)} or its fields as keywords.")
    return ready
