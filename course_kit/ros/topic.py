"""A subscription that keeps what comes, and the quality of service that fits the other end of a topic.

Nothing here waits: whoever reads spins, awaits, or looks now and then what has come.
"""

from __future__ import annotations

from collections import deque
from itertools import islice
from typing import TYPE_CHECKING, TypedDict

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rclpy.node import Node
    from rclpy.subscription import Subscription
    from rclpy.topic_endpoint_info import TopicEndpointInfo

    from course_kit.ros.messages import Message, MessageType

_NS = 1e9
# Unless they are switched off these cost at each turn; they log that the other side's quality of service does not fit.
NO_SUBSCRIPTION_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
NO_PUBLISHER_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)


class MessageInfo(TypedDict):
    """What rclpy tells of a message beside it; times are nanoseconds of the system's clock."""

    source_timestamp: int
    received_timestamp: int


class Inbox:
    """What has come on a topic."""

    def __init__(self, kept: int | None = None) -> None:
        self.count = 0
        self.messages: deque[Message] = deque(maxlen=kept)
        self.times: deque[float] = deque(maxlen=kept)

    def take(self, message: Message, info: MessageInfo) -> None:
        """Take one message in, with the time the middleware noted, however late it is looked at."""
        self.count += 1
        self.keep(message, info["received_timestamp"] / _NS)

    def keep(self, message: Message, received_s: float) -> None:
        """Keep one message; for a subclass that wants only some, or something of each."""
        self.messages.append(message)
        self.times.append(received_s)

    def newer_than(self, count: int) -> list[Message]:
        """The messages after the first `count`, as far as they are kept."""
        forgotten = self.count - len(self.messages)
        return list(islice(self.messages, max(count - forgotten, 0), None))

    def subscribe(  # noqa: PLR0913 - what rclpy asks for, and two switches
        self,
        node: Node,
        message_type: MessageType,
        topic: str,
        qos: QoSProfile | int,
        *,
        quiet: bool = False,
        raw: bool = False,
    ) -> Subscription:
        """Take in what comes on a topic from now on."""
        events = NO_SUBSCRIPTION_EVENTS if quiet else None
        take: Callable[..., None] = self.take  # of two arguments, which rclpy allows and its types do not tell
        return node.create_subscription(message_type, topic, take, qos, event_callbacks=events, raw=raw)


def as_offered(depth: int = 10, keepers: Sequence[TopicEndpointInfo] = ()) -> QoSProfile:
    """A profile for a subscription that connects with all publishers that are on the topic when it is made."""
    local = bool(keepers) and all(end.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for end in keepers)
    durability = DurabilityPolicy.TRANSIENT_LOCAL if local else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_AVAILABLE, durability=durability)
