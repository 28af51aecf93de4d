"""Publishing and receiving from a notebook, in two small verbs."""

from __future__ import annotations

import asyncio
import threading
import time
from typing import TYPE_CHECKING

from course_kit.lab.errors import NoAnswerError
from course_kit.lab.messages import require_message_type
from course_kit.ros.messages import type_name
from course_kit.ros.qos import as_offered

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.publisher import Publisher
    from rclpy.qos import QoSProfile
    from rclpy.subscription import Subscription as RclpySubscription

    from course_kit.lab.runtime.engine import Engine
    from course_kit.ros.messages import Message

_MATCHING = 1.0  # seconds a new publisher waits for the subscriptions that are on the graph
_DELIVERY = 1.0  # seconds the lab's own subscriptions are given to take what was published
_POLL = 0.005
_DEPTH = 10


def wait_for_subscriptions(node: Node, publisher: Publisher) -> None:
    """Wait until a publisher is connected to the subscriptions that are there, so that none misses the first message.

    At most one second: a subscription of another type or quality of service never connects.
    """
    _wait_while(lambda: publisher.get_subscription_count() < node.count_subscribers(publisher.topic_name))


def _wait_while(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + _MATCHING
    pause = threading.Event()  # the graph has no event to wait for in rclpy: look often, with a deadline
    while condition() and time.monotonic() < deadline:
        pause.wait(_POLL)


class Subscription:
    """A function that is called with each message of a topic, until `close`.

    Making one waits until it is connected to the publishers that are there, one second at most, so that what they
    publish next is not missed.

    Attributes:
        topic: the topic's full name.
    """

    def __init__(
        self,
        lab: Engine,
        topic: str,
        message_type: type[Message],
        callback: Callable[[Message], None],
        qos: QoSProfile | None = None,
    ) -> None:
        self._lab = lab
        self._type = type_name(message_type)
        self._open = True
        self._subscription = lab.clients.subscription(message_type, topic, callback, qos or as_offered(_DEPTH))
        self.topic: str = self._subscription.topic_name
        if not lab.in_callback():
            node, new = lab.node, self._subscription
            _wait_while(lambda: new.get_publisher_count() < node.count_publishers(self.topic))

    def close(self) -> None:
        """End it: the callback is not called again. Safe to call twice, and after the lab has ended."""
        if self._open:
            self._open = False
            self._lab.destroy_subscription(self._subscription)

    def __repr__(self) -> str:
        return f"subscription to {self.topic} [{self._type}]{'' if self._open else ' (closed)'}"


def publish(lab: Engine, publisher: Publisher, message: Message) -> None:
    """Publish, and return when the callbacks of this lab's subscriptions have had the message.

    So what they print is printed with the cell that published. At most one second: a subscription of another
    quality of service gets nothing, and a callback may take long.

    Args:
        lab: whose publisher it is.
        publisher: of the topic.
        message: what is sent.
    """
    if lab.in_callback() or not lab.tells_deliveries():  # in a callback this is the thread that would deliver
        publisher.publish(message)
        return
    waiting = lab.subscriptions(publisher.topic_name, publisher.msg_type)
    all_had_it = threading.Event()

    def had(subscription: RclpySubscription) -> None:
        waiting.discard(subscription)
        if not waiting:
            all_had_it.set()

    lab.listen_for_deliveries(had, listen=True)
    try:
        publisher.publish(message)
        if waiting:
            all_had_it.wait(_DELIVERY)
    finally:
        lab.listen_for_deliveries(had, listen=False)
        lab.flush_output()


async def next_messages(
    lab: Engine, topic: str, message_type: type[Message], count: int, timeout: float
) -> list[Message]:
    """Subscribe, and return the next messages once there are `count`.

    Args:
        lab: the lab.
        topic: its name.
        message_type: its class.
        count: how many.
        timeout: seconds for all of them.

    Raises:
        NoAnswerError: fewer came within `timeout` seconds; says who publishes what on that topic.
    """
    require_message_type(message_type)
    loop = asyncio.get_running_loop()
    complete = loop.create_future()
    received: list[Message] = []

    def finish() -> None:
        if not complete.done():
            complete.set_result(None)

    def keep(message: Message) -> None:
        if len(received) < count:
            received.append(message)
            if len(received) == count:
                loop.call_soon_threadsafe(finish)

    subscription = lab.node.create_subscription(message_type, topic, keep, as_offered(max(_DEPTH, count)))
    try:
        await asyncio.wait_for(complete, timeout)
    except (TimeoutError, asyncio.TimeoutError):  # two types until Python 3.11
        came = f"{len(received)} of {count} messages" if received else "No message"
        text = f"{came} came on {subscription.topic_name} within {timeout:g} s."
        raise NoAnswerError(f"{text} {_why_none(lab.node, subscription)}") from None
    finally:
        lab.destroy_subscription(subscription)
        lab.flush_output()
    return received


def _why_none(node: Node, subscription: RclpySubscription) -> str:
    publishers = node.get_publishers_info_by_topic(subscription.topic_name)
    if not publishers:
        return "No node publishes it."
    types = sorted({publisher.topic_type for publisher in publishers})
    wanted = type_name(subscription.msg_type)
    if types != [wanted]:
        return f"It is published as {', '.join(types)}, but you asked for {wanted}."
    names = sorted({publisher.node_name for publisher in publishers})
    return f"{', '.join(names)} has a publisher for it but may not have published yet."
