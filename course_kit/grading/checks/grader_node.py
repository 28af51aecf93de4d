"""The grader's own node: a context, a node and what receives for it on one thread, in one ROS domain."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import rclpy
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions

from course_kit.grading.bounds import bounded
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.receiving import receiver
from course_kit.ros import graph
from course_kit.ros.node import quiet_node

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.client import Client
    from rclpy.publisher import Publisher
    from rclpy.qos import QoSProfile

_KEPT = 1000  # messages of a topic; a program in a hurry sends more in a second
DEPTH = 10  # of queues, as the tutorials of ROS 2 have it
_OF_EVERY_NODE = ("/rosout", "/parameter_events")
_FOR_PARAMETERS = ("rcl_interfaces/srv/", "type_description_interfaces/srv/")
NAME = "_course_kit_grader"  # hidden from `ros2 node list`, as names with an underscore are
# What these have unless it is switched off costs at each turn, and nobody asks the grader for it.
_NO_PUBLISHER_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
_NO_SUBSCRIPTION_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)


@dataclass(frozen=True)
class Offer:
    """A service or an action somebody on the graph offers."""

    name: str
    type: str
    node: str


@dataclass(frozen=True)
class Endpoint:
    """A publisher or a subscription of somebody on the graph."""

    node: str
    type: str
    qos: QoSProfile


class Heard:
    """What has come on a topic.

    Attributes:
        count: how many messages.
        messages: the last of them, oldest first; each with its texts and sequences cut where they are too long.
        times: when each of these was received, in seconds of the system's clock; when it was sent only the publisher
            could say.
    """

    def __init__(self) -> None:
        self.count = 0
        self.messages: deque[Any] = deque(maxlen=_KEPT)
        self.times: deque[float] = deque(maxlen=_KEPT)

    def take(self, message: Any, info: Any) -> None:
        """Keep one message; `info` is rclpy's, with the time the middleware noted, however late we look."""
        self.count += 1
        self.messages.append(bounded(message))
        self.times.append(info["received_timestamp"] / 1e9)

    def after(self, moment: float) -> list[Any]:
        """The messages that were received from a moment on, as far as they are kept.

        Args:
            moment: in seconds of the system's clock.
        """
        return [message for message, time in zip(self.messages, self.times, strict=True) if time >= moment]

    def since(self, count: int) -> list[Any]:
        """The messages after the first `count`, as far as they are kept."""
        forgotten = self.count - len(self.messages)
        return list(islice(self.messages, max(count - forgotten, 0), None))


class _TakesMessages(Protocol):
    def take(self, message: Any, info: Any) -> None:
        """Keep what is wanted of a message."""


Listener = TypeVar("Listener", bound=_TakesMessages)


class GraderNode:
    """The grader on the graph. Its own endpoints never appear in what it reports."""

    def __init__(self, domain: int | None) -> None:
        """Join the graph of `domain`, or of ROS_DOMAIN_ID when None."""
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        self.node = quiet_node(NAME, self._context)
        self._receiver = receiver(self.node)
        self._clients: dict[tuple[str, int], Client] = {}
        self._heard: dict[str, Any] = {}
        self._publishers: dict[str, Publisher] = {}

    @property
    def domain(self) -> int:
        """The ROS domain it is in."""
        return int(self._context.get_domain_id())

    def spin_once(self, timeout_s: float) -> None:
        """Take in what has come, or wait for something at most `timeout_s` seconds.

        Raises:
            Failed: what has come is too large to be taken in, with limit.memory.
        """
        if not self._context.ok():
            raise ExternalShutdownException
        try:
            self._receiver.receive(timeout_s)
        except (MemoryError, SystemError):  # the second, where an allocation in rclpy's own code has failed
            evidence = Evidence(got="messages too large for the grader's memory")
            message = (
                "Your program sends more data than the grader can hold in memory: messages that are too "
                "large, or too many of them."
            )
            raise Failed(evidence, message, "limit.memory") from None

    def client(self, interface: Any, name: str, number: int = 0) -> Client:
        """The client `number` of a service; made on first use and kept, so that it is connected the next time.

        Args:
            interface: the service's class.
            name: its full name.
            number: to have several clients of one service.
        """
        key = (name, number)
        if key not in self._clients:
            self._clients[key] = self.node.create_client(interface, name)
            self._receiver.add_client(self._clients[key])
        return self._clients[key]

    def hear(self, interface: Any, topic: str) -> Heard:
        """What comes on a topic, from the first use on; with the default profile of depth 10."""
        return self.hear_with(Heard, interface, topic, DEPTH)

    def hear_with(self, make: Callable[[], Listener], interface: Any, topic: str, qos: QoSProfile | int) -> Listener:
        """What `make` has made on first use, and what has taken every message on a topic since.

        Args:
            make: makes what takes the messages.
            interface: their class.
            topic: the topic's full name.
            qos: a profile, or the depth of the default one.
        """
        if topic not in self._heard:
            self._heard[topic] = heard = make()
            take: Any = heard.take  # of two arguments, which rclpy allows and its types do not tell
            made = self.node.create_subscription(interface, topic, take, qos, event_callbacks=_NO_SUBSCRIPTION_EVENTS)
            self._receiver.add_subscription(made, heard.take)
        listener: Listener = self._heard[topic]
        return listener

    def publisher(self, interface: Any, topic: str) -> Publisher:
        """The publisher on a topic, with the default QoS profile of depth 10; made on first use and kept."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(
                interface, topic, DEPTH, event_callbacks=_NO_PUBLISHER_EVENTS
            )
        return self._publishers[topic]

    def publishers(self, topic: str) -> list[Endpoint]:
        """Who else publishes on a topic."""
        return _endpoints(self.node.get_publishers_info_by_topic(topic))

    def subscriptions(self, topic: str) -> list[Endpoint]:
        """Who else subscribes to a topic."""
        return _endpoints(self.node.get_subscriptions_info_by_topic(topic))

    def topics(self) -> list[str]:
        """The names of all topics but those every node has and those only the grader uses."""
        names = (name for name, _ in self.node.get_topic_names_and_types() if name not in _OF_EVERY_NODE)
        return [name for name in names if self.publishers(name) or self.subscriptions(name)]

    def nodes(self) -> list[str]:
        """Full names of all other nodes; a name stands as often as nodes carry it."""
        return [name for name in graph.nodes(self.node) if not name.endswith(f"/{NAME}")]

    def services(self) -> list[Offer]:
        """The services that other nodes offer, but for those every node has for its parameters."""
        return [offer for offer in self._offers(graph.SERVES) if not offer.type.startswith(_FOR_PARAMETERS)]

    def actions(self) -> list[Offer]:
        """The actions that other nodes offer."""
        return self._offers(graph.RUNS)

    def close(self) -> None:
        """Leave the graph. Safe to call twice."""
        if self._context.ok():
            self._receiver.close()
            self.node.destroy_node()
            self._context.try_shutdown()

    def _offers(self, role: graph.Role) -> list[Offer]:
        uses = (use for name in self.nodes() for use in graph.uses_of(self.node, name, role))
        return [Offer(use.channel, kind, use.node) for use in uses for kind in use.types]


def _endpoints(found: Any) -> list[Endpoint]:
    return [Endpoint(one.node_name, one.topic_type, one.qos_profile) for one in found if one.node_name != NAME]
