"""Calling a service: one exchange, driven by asyncio in a notebook and by a wait in a program.

The lab has one hidden node for its own calls and keeps one client for each service it has called.
"""

from __future__ import annotations

import asyncio
import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from rclpy.exceptions import InvalidHandle

from course_kit.lab import graph
from course_kit.lab.errors import FieldError, NoAnswerError, ServiceFailedError, ServiceNotFoundError
from course_kit.lab.messages import build
from course_kit.ros.graph import SERVES
from course_kit.ros.messages import is_service_type, type_name

if TYPE_CHECKING:
    from collections.abc import Callable

APPEARANCE = 2.0  # seconds a service is given to appear on the graph; discovery takes a tenth of that
_POLL = 0.005  # seconds between looks at the graph, which cost microseconds
_CHECK = 0.2  # seconds between looks at whether the server is still there


class Surroundings(Protocol):
    """What a call needs to know about the lab."""

    @property
    def node(self) -> Any:
        """The lab's own node."""

    @property
    def own_names(self) -> frozenset[str]:
        """Names of nodes that are the lab's own."""

    def client(self, service_type: Any, service: str) -> Any:
        """The lab's client for a service."""

    def destroy_subscription(self, subscription: Any) -> None:
        """Destroy a subscription of the lab's node."""

    def why_no_answer(self, service: str) -> str:
        """What is known about a server that does not answer."""

    def before_blaming(self) -> None:
        """A server has gone: let a script that is about to end say why first."""

    def flush_output(self) -> None:
        """Show what callbacks have printed; called in the caller's thread."""


class PendingCall(Protocol):
    """Something sent and the wait for what comes back; both drivers below know no more of it."""

    def may_send(self) -> bool:
        """Whether the server is there; raises when it has been waited for long enough."""

    def send(self, completed: Callable[[], None]) -> None:
        """Send; `completed` is called on the lab's thread when the answer is there."""

    def next_check(self) -> float:
        """Seconds until `check` should be called."""

    def check(self) -> None:
        """Look whether an answer can still come; raises if not."""

    def result(self) -> Any:
        """What came back."""

    def close(self) -> None:
        """Stop waiting, whether or not the answer has come."""


class Asked(NamedTuple):
    """What a caller wants.

    Attributes:
        request: a ready request, or None to build one of `fields`.
        fields: the request's fields.
        timeout: seconds until the answer must be there.
    """

    request: Any
    fields: dict[str, Any]
    timeout: float


class ServiceExchange:
    """One request and the wait for its response.

    Args:
        lab: the surroundings.
        service: the service's name; a relative one counts from the root namespace.
        service_type: its class.
        asked: the request and how long to wait.

    Raises:
        FieldError: the request cannot be built.
    """

    def __init__(self, lab: Surroundings, service: str, service_type: Any, asked: Asked) -> None:
        if not is_service_type(service_type):
            raise FieldError(_not_a_service(service_type))
        self._lab = lab
        self._type = type_name(service_type)
        request = asked.request
        if request is None:
            request = build(service_type.Request, asked.fields, f"a {self._type} request")
        elif asked.fields or not isinstance(request, service_type.Request):
            raise FieldError(f"Pass either a {self._type} request or its fields as keywords.")
        self._request = request
        self._client = lab.client(service_type, service)
        self._service: str = self._client.service_name
        self._timeout = asked.timeout
        self._start = time.monotonic()
        self._future: Any = None

    def may_send(self) -> bool:
        """Whether the server is there.

        Raises:
            ServiceNotFoundError: it has been waited for long enough.
        """
        if self._is_there():
            return True
        waited = min(APPEARANCE, self._timeout)
        if time.monotonic() - self._start < waited:
            return False
        raise ServiceNotFoundError(
            graph.not_offered(
                self._lab.node, graph.WantedServer(SERVES, self._service, self._type), waited, self._lab.own_names
            )
        )

    def send(self, completed: Callable[[], None]) -> None:
        """Send the request; `completed` is called on the lab's thread when the answer is there."""
        self._future = self._client.call_async(self._request)
        self._future.add_done_callback(lambda _: completed())

    def next_check(self) -> float:
        """Seconds until `check` should be called."""
        return max(0.0, min(_CHECK, self._start + self._timeout - time.monotonic()))

    def check(self) -> None:
        """Look whether an answer can still come.

        Raises:
            NoAnswerError: the time is over, or the server has gone.
        """
        if self._future.done():
            return
        if time.monotonic() - self._start >= self._timeout:
            why = self._lab.why_no_answer(self._service)
            raise NoAnswerError(f"{self._service} did not answer within {self._timeout:g} s. {why}")
        if not self._is_there():
            self._lab.before_blaming()
            raise NoAnswerError(
                f"The server of {self._service} went away before it answered: "
                "its program ended or its node was stopped. Its own output says why."
            )

    def _is_there(self) -> bool:
        try:
            return bool(self._client.service_is_ready())
        except InvalidHandle:  # the lab is being closed
            return False

    def result(self) -> Any:
        """The response.

        Raises:
            ServiceFailedError: the callback in this lab gave none.
        """
        error = self._future.exception()
        if isinstance(error, ServiceFailedError):
            raise ServiceFailedError(str(error)) from None  # a fresh one: an exception keeps the frames it passed
        if error is not None:
            raise error
        return self._future.result()

    def close(self) -> None:
        """Stop waiting, whether or not the answer has come; harmless if it has."""
        if self._future is not None and not self._future.done():
            self._future.cancel()
        self._lab.flush_output()


async def call_async(exchange: PendingCall) -> Any:
    """Drive an exchange from asyncio; uses no time while it waits."""
    loop = asyncio.get_running_loop()
    try:
        while not exchange.may_send():  # noqa: ASYNC110 - rclpy has no event for changes of the graph
            await asyncio.sleep(_POLL)
        answered = loop.create_future()

        def wake() -> None:
            if not answered.done():
                answered.set_result(None)

        def completed() -> None:
            with suppress(RuntimeError):  # the loop is closed: nobody waits
                loop.call_soon_threadsafe(wake)

        timer: asyncio.TimerHandle | None = None

        def look() -> None:
            nonlocal timer
            try:
                exchange.check()
            except Exception as error:  # noqa: BLE001 - whatever it is, the caller must not wait for ever
                if not answered.done():
                    answered.set_exception(error)
            else:
                timer = loop.call_later(exchange.next_check(), look)

        exchange.send(completed)
        timer = loop.call_later(exchange.next_check(), look)
        try:
            await answered
        finally:
            timer.cancel()
        return exchange.result()
    finally:
        exchange.close()


def call_blocking(exchange: PendingCall, show: Callable[[], None]) -> Any:
    """Drive an exchange from a plain function; `show` is called now and then. Ctrl-C interrupts it."""
    pause = threading.Event()
    try:
        while not exchange.may_send():
            pause.wait(_POLL)
        exchange.send(pause.set)
        while not pause.wait(exchange.next_check()):
            exchange.check()
            show()
        return exchange.result()
    finally:
        exchange.close()


def _not_a_service(given: Any) -> str:
    hint = ""
    owner = getattr(given, "__name__", "")
    if owner.endswith(("_Request", "_Response")):
        hint = f" Use {owner.rpartition('_')[0]} itself."
    elif not isinstance(given, type):
        hint = " The order is: lab.call(name, Type, field=value)."
    return f"{owner or repr(given)} is not a service type.{hint}"
