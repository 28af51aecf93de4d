"""Hooks at the boundary of rclpy: what a node sends and what its executor takes for it.

Sending is seen by wrapping `Client.call_async` and `Publisher.publish`. Receiving is seen in the three methods by which
rclpy's Executor takes work from the middleware (`_take_service`, `_take_client`, `_take_subscription`): only they have
both the message and the number of its request. When a thread is inside a callback is reported, too.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
import itertools
import os
import threading
import time
import types
from typing import TYPE_CHECKING, Any
from weakref import WeakSet

from rclpy.exceptions import InvalidHandle
from rclpy.subscription import Subscription

from course_kit.lab.errors import CallbackStopped, error_text
from course_kit.ros.messages import type_name
from course_kit.ros.names import is_hidden, is_of_every_node

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine, Generator, Iterator

    from rclpy.client import Client
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.service import Service
    from rclpy.task import Future
    from rclpy.timer import Timer

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.recording.events import EventStream
    from course_kit.ros.messages import ActionType, Message, ServiceType

    Work = Callable[[], Coroutine[object, None, None]]
    Where = tuple[str, str, str]

_NODE = "_course_kit_node"  # on a timer: the name of its node
_SEQUENCE = "_course_kit_sequence"  # on a future: the number of its request
_WHERE = "_course_kit_where"  # on a client, service, publisher or subscription: what `identify` has found out
# rclpy publishes these on its own; a learner never meant to.
_SILENT_TOPICS = frozenset({"/parameter_events", "/rosout", "/_lab/nodes", "/_lab/stop"})  # the last two are the lab's


class WrongResponseError(TypeError):
    """A service callback returned something that is not its service's response."""

    def __init__(self, returned: object, service_type: ServiceType) -> None:
        if returned is None:
            self.what = "returned nothing. End it with `return response`."
        elif isinstance(returned, service_type.Request):
            self.what = "returned the request. Fill in the response and end with `return response`."
        else:
            self.what = (
                f"returned {type(returned).__name__}, which is not a response of {type_name(service_type)}. "
                "Fill in the response it was given and end with `return response`."
            )
        super().__init__(f"the service callback {self.what}")


class WrongResultError(WrongResponseError):
    """An execute callback returned something that is not its action's result."""

    def __init__(self, returned: object, action_type: ActionType) -> None:
        name = type_name(action_type)
        advice = f"End it with `return {name.rpartition('/')[2]}.Result(...)`."
        if returned is None:
            self.what = f"returned nothing. {advice}"
        elif isinstance(returned, type):
            self.what = f"returned the class {returned.__name__}, without parentheses. {advice}"
        else:
            self.what = f"returned {type(returned).__name__}, which is not a result of {name}. {advice}"
        TypeError.__init__(self, f"the execute callback {self.what}")


class CallbackSpans:
    """Reports pieces of callbacks as events: where, and as its value the thread, the process, and what is called."""

    def __init__(self, events: EventStream) -> None:
        self._events = events
        self._numbers = itertools.count(1)

    @contextlib.contextmanager
    def span(self, where: Where, what: str) -> Iterator[None]:
        """Report that the thread is inside a callback meanwhile."""
        number, process = next(self._numbers), os.getpid()
        thread = threading.current_thread()
        value = {"what": what, "thread": thread.name, "ident": threading.get_ident(), "process": process}
        self._events.emit("callback_begun", where, value, number)
        failed = True
        try:
            yield
            failed = False
        finally:
            self._events.emit("callback_ended", where, {"failed": failed, "process": process}, number)

    @types.coroutine
    def steps(self, awaitable: Awaitable[Any], where: Where, what: str) -> Generator[Any, Any, Any]:
        """Drive something awaitable, and report each of its steps."""
        steps: Any = awaitable.__await__()
        sent = None
        try:
            while True:
                with self.span(where, what):
                    try:
                        awaited = steps.send(sent) if hasattr(steps, "send") else next(steps)
                    except StopIteration as end:
                        return end.value
                sent = yield awaited
        finally:
            if hasattr(steps, "close"):
                steps.close()

    def report_work(self, work: Work, where: Where, what: str) -> Work:
        """The same work, reported while it runs."""

        async def reported() -> None:
            await self.steps(work(), where, what)

        return reported


class MessageHooks:
    """Sees messages cross and reports them to `events`."""

    def __init__(self, events: EventStream) -> None:
        self.events = events
        self.aliases: dict[str, str] = {}
        self.direct: WeakSet[Client] = WeakSet()  # whose answers are handed over on the thread that takes them
        self.own_nodes: set[Node] = set()  # of the lab itself
        self.clients: WeakSet[Client] = WeakSet()  # that have asked
        self.on_failure: Callable[[Service, int, BaseException], None] = lambda *_: None  # with the request's number
        self.on_delivery: set[Callable[[Subscription], None]] = set()
        self.spans = CallbackSpans(events)

    def identify(self, entity: Any) -> Where:
        """The node, the full name and the type of a client, service, publisher or subscription."""
        known: Where | None = vars(entity).get(_WHERE)
        if known is None:
            node = "/" + entity.logger_name.replace(".", "/")
            interface = getattr(entity, "srv_type", None) or entity.msg_type
            channel = entity.service_name if hasattr(entity, "srv_type") else entity.topic_name
            known = (self.aliases.get(node, node), channel, type_name(interface))
            setattr(entity, _WHERE, known)
        return known

    def hook_sending(self, patches: Patches) -> None:
        from rclpy.client import Client
        from rclpy.publisher import Publisher

        call_async = Client.call_async
        publish = Publisher.publish

        def call_async_seen(client: Client, request: Message) -> Future:
            self.clients.add(client)
            if not self.events.observers:
                return call_async(client, request)
            before = time.monotonic_ns()  # the answer may be here before `call_async` returns
            future = call_async(client, request)
            self.events.emit("request_sent", self.identify(client), request, _sequence_of(client, future), before)
            return future

        def publish_seen(publisher: Publisher, message: Message) -> None:
            kind: Any = publisher.msg_type  # a class, which its type in rclpy does not say
            if self.events.observers and not isinstance(message, bytes) and isinstance(message, kind):
                where = self.identify(publisher)
                if where[1] not in _SILENT_TOPICS:
                    self.events.emit("published", where, message)
            publish(publisher, message)

        patches.set(Client, "call_async", call_async_seen)
        patches.set(Publisher, "publish", publish_seen)

    def hook_taking(self, patches: Patches, executors: type[Executor]) -> None:
        """Have executors of a class take by way of these hooks."""
        original: Any = executors._take_timer  # noqa: SLF001 - the only place that has the timer and its work

        patches.set(executors, "_take_timer", lambda own, timer: self.take_timer(own, timer, original(own, timer)))
        patches.set(executors, "_take_client", lambda own, client: self.take_client(own, client))  # noqa: PLW0108 - becomes a method
        patches.set(executors, "_take_service", lambda _, service: self.take_service(service))
        patches.set(executors, "_take_subscription", lambda _, subscription: self.take_subscription(subscription))

    def take_service(self, service: Service) -> Work | None:
        """Take a request and return the work of answering it, as `Executor._take_service` does."""
        kind: Any = service.srv_type
        try:
            with service.handle:
                request, header = service.handle.service_take_request(kind.Request)
        except InvalidHandle:  # destroyed meanwhile
            return None
        if header is None:
            return None
        sequence = _sequence(header)

        async def answer() -> None:
            self._emit("request_received", service, request, sequence)
            try:
                response = await _run(service.callback, request, kind.Response())
                if not isinstance(response, kind.Response):
                    raise WrongResponseError(response, kind)  # noqa: TRY301 - one way out for all failures
                # Before it is sent: whoever has the answer can be sure that the event is there as well.
                self._emit("response_sent", service, response, sequence)
                service.send_response(response, header)
            except InvalidHandle:
                return
            except (CallbackStopped, GeneratorExit):  # its node was stopped
                raise
            except BaseException as error:
                self._emit("callback_failed", service, failure_text(error), sequence)
                self.on_failure(service, sequence, error)
                raise

        return self._report_callback(answer, service, "service")

    def take_client(self, executor: Executor, client: Client) -> Work | None:
        """Take an answer and return the work of handing it to whoever waits, as `Executor._take_client` does."""
        kind: Any = client.srv_type
        try:
            with client.handle:
                header, response = client.handle.take_response(kind.Response)
        except InvalidHandle:
            return None
        if header is None:
            return None
        sequence = _sequence(header)

        async def hand_over() -> None:
            try:
                future = client.get_pending_request(sequence)
            except KeyError:  # nobody waits
                return
            setattr(future, _SEQUENCE, sequence)  # for whoever has asked, and looks for it only now
            self._emit("response_received", client, response, sequence)
            if client not in self.direct:
                future._set_executor(executor)  # noqa: SLF001 - as rclpy does, so that callbacks run as tasks
            future.set_result(response)

        return hand_over

    def take_subscription(self, subscription: Subscription) -> Work | None:
        """Take a message and return the work of the callback, as `Executor._take_subscription` does."""
        try:
            with subscription.handle:
                taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
        except InvalidHandle:
            return None
        if taken is None:
            return None
        message_only = subscription._callback_type is Subscription.CallbackType.MessageOnly  # noqa: SLF001
        arguments = taken[:1] if message_only else taken

        async def deliver() -> None:
            if not subscription.raw:
                self._emit("received", subscription, taken[0], 0)
            try:
                await _run(subscription.callback, *arguments)
            finally:
                for listener in tuple(self.on_delivery):
                    listener(subscription)

        return self._report_callback(deliver, subscription, "topic")

    def take_timer(self, executor: Executor, timer: Timer, work: Work | None) -> Work | None:
        """What `Executor._take_timer` has returned, reported while it runs."""
        if work is None or not self.events.observers:
            return work
        node = vars(timer).get(_NODE)
        if node is None:
            owners = [node for node in executor.get_nodes() if any(timer is own for own in node.timers)]
            node = owners[0].get_fully_qualified_name() if owners else ""
            setattr(timer, _NODE, node)
        if not node or is_hidden(node):  # the lab's own
            return work
        return self.spans.report_work(work, (node, getattr(timer.callback, "__name__", "timer"), ""), "timer")

    def _report_callback(self, work: Work, entity: Any, what: str) -> Work:
        """The work, reported while it runs, unless it is that of the lab itself or of ROS."""
        if not self.events.observers:
            return work
        try:
            where = self.identify(entity)
        except InvalidHandle:
            return work
        own = where[0] in self.aliases.values()
        return work if own or _is_of_ros(where[1]) else self.spans.report_work(work, where, what)

    def _emit(self, kind: Any, entity: Any, message: object, sequence: int) -> None:
        if self.events.observers:
            try:
                where = self.identify(entity)
            except InvalidHandle:
                return
            if where[1] not in _SILENT_TOPICS:
                self.events.emit(kind, where, message, sequence)


@functools.lru_cache(maxsize=256)
def _is_of_ros(channel: str) -> bool:
    """Whether ROS or the lab speaks there, and no learner's callback."""
    return channel in _SILENT_TOPICS or is_of_every_node(channel)


def _sequence_of(client: Client, future: Future) -> int:
    """The number of a request just sent, whose answer may have come and gone already."""
    with client._lock:  # noqa: SLF001
        pending = client._pending_requests  # noqa: SLF001
        for number in reversed(pending):  # it is the newest one, unless two threads use one client
            if pending[number] is future:
                return int(number)
    return int(vars(future).get(_SEQUENCE, 0))


def failure_text(error: BaseException) -> str:
    """An error's name and the first line of its text."""
    first = (error_text(error).splitlines() or [""])[0]
    if isinstance(error, WrongResponseError):
        return first
    return f"{type(error).__name__}: {first}" if first else type(error).__name__


async def _run(callback: Any, *arguments: Any) -> Any:
    if inspect.iscoroutinefunction(callback):
        return await callback(*arguments)
    return callback(*arguments)


def _sequence(header: Any) -> int:
    return int(getattr(header, "request_id", header).sequence_number)  # of a request or of what is known about one
