"""Publishing and receiving from a notebook, in two small verbs."""

from __future__ import annotations

import asyncio
import threading
from typing import TYPE_CHECKING

from course_kit.lab.calls import make_waker, message_of, require_message_type
from course_kit.lab.errors import NoAnswerError
from course_kit.ros import compat
from course_kit.ros.messages import type_name
from course_kit.ros.topic import as_offered

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.qos import QoSProfile
    from rclpy.subscription import Subscription as RclpySubscription

    from course_kit.lab.runtime.engine import Engine
    from course_kit.ros.filling import Fields
    from course_kit.ros.messages import Message

_DELIVERY = 1.0  # seconds the lab's own subscriptions are given to take what was published
_DEPTH = 10


class Subscription:
    """A function that is called with each message of a topic, until `close`."""

    def __init__(
        self,
        lab: Engine,
        topic: str,
        message_type: type[Message],
        callback: Callable[[Message], None],
        qos: QoSProfile | None = None,
    ) -> None:
        require_message_type(message_type)
        self._lab = lab
        self._type = type_name(message_type)
        self._open = True
        self._subscription = lab.clients.subscription(message_type, topic, callback, qos or as_offered(_DEPTH))
        self.topic: str = self._subscription.topic_name

    @property
    def is_open(self) -> bool:
        """Whether it has not been closed."""
        return self._open

    def close(self) -> None:
        """End it: the callback is not called again. Safe to call twice, and after the lab has ended."""
        if self._open:
            self._open = False
            _destroy(self._lab, self._subscription)

    def __repr__(self) -> str:
        return f"subscription to {self.topic} [{self._type}]{'' if self._open else ' (closed)'}"


class DeliveryWait:
    """Waits for the lab's own subscriptions to a topic, so that what they print stands where it was caused."""

    def __init__(self, lab: Engine, topic: str, message_type: object) -> None:
        self._lab = lab
        nodes = [*(live.node for live in lab.nodes.live), *lab.hooks.own_nodes]
        known = [end for node in nodes for end in node.subscriptions] if lab.found.has(compat.RECORDING) else []
        mine = [end for end in known if end.topic_name == topic and end.msg_type is message_type]
        self._counts: dict[RclpySubscription, int] = dict.fromkeys(mine, 0)
        self._expected = 0
        self._complete = threading.Event()

    def __enter__(self) -> DeliveryWait:  # noqa: PYI034 - typing.Self is newer than Python 3.10
        self._lab.hooks.on_delivery.add(self._count)
        return self

    def __exit__(self, *_: object) -> None:
        self._lab.hooks.on_delivery.discard(self._count)
        self._lab.output.drain()

    def wait(self, count: int) -> None:
        """Return when all have had so many messages, or after a second."""
        self._expected = count
        if not self._is_complete():
            self._complete.wait(_DELIVERY)

    def _count(self, subscription: RclpySubscription) -> None:
        if subscription in self._counts:
            self._counts[subscription] += 1
            if self._expected and self._is_complete():
                self._complete.set()

    def _is_complete(self) -> bool:
        return all(count >= self._expected for count in self._counts.values())


def publish(lab: Engine, topic: str, message_type: type[Message], message: Message, fields: Fields) -> None:
    """Publish a message; return when the subscriptions of this lab have had it."""
    require_message_type(message_type)
    ready = message_of(message_type, message, fields)
    publisher = lab.clients.publisher(message_type, topic)
    if lab.in_callback():  # this is the thread that would deliver
        publisher.publish(ready)
        return
    with DeliveryWait(lab, publisher.topic_name, publisher.msg_type) as deliveries:
        publisher.publish(ready)
        deliveries.wait(1)


async def next_messages(
    lab: Engine, topic: str, message_type: type[Message], count: int, timeout: float
) -> list[Message]:
    """Subscribe, and return the next messages once there are `count`."""
    require_message_type(message_type)
    news, wake = make_waker()
    received: list[Message] = []

    def keep(message: Message) -> None:
        if len(received) < count:
            received.append(message)
            if len(received) == count:
                wake()

    subscription = lab.node.create_subscription(message_type, topic, keep, as_offered(max(_DEPTH, count)))
    deadline = asyncio.get_running_loop().call_later(timeout, news.set)
    try:
        # Not with asyncio.wait_for, which until Python 3.11 loses an interrupt that comes with a message.
        await news.wait()
        if len(received) < count:
            came = f"{len(received)} of {count} messages" if received else "No message"
            text = f"{came} came on {subscription.topic_name} within {timeout:g} s."
            raise NoAnswerError(f"{text} {_why_none(lab, subscription)}")
    finally:
        deadline.cancel()
        _destroy(lab, subscription)
        lab.output.drain()
    return received


def _why_none(lab: Engine, subscription: RclpySubscription) -> str:
    found = lab.node.get_publishers_info_by_topic(subscription.topic_name)
    if not found:
        return "No node publishes it."
    types = sorted({end.topic_type for end in found})
    wanted = type_name(subscription.msg_type)
    if types != [wanted]:
        return f"It is published as {', '.join(types)}, but you asked for {wanted}."
    known = [end.node_name for end in found]
    names = sorted({"a node that is just starting" if name == "_NODE_NAME_UNKNOWN_" else name for name in known})
    for crash in (lab.failures.latest[name] for name in names if name in lab.failures.latest):
        return f"{crash.node} publishes it, but its {crash.callback or 'callback'} {crash.error} ({crash.place})."
    return f"{', '.join(names)} has a publisher for it but may not have published yet."


def _destroy(lab: Engine, subscription: RclpySubscription) -> None:
    lab.executor_thread.run_between_callbacks(lambda: lab.node.destroy_subscription(subscription), 1.0)
