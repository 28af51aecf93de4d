"""Looks at the graph through a node of this process, and knows when it has seen all of it."""

from __future__ import annotations

import os
import time
from collections import Counter
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_kit.environment.visitor import visit_graph
from course_kit.ros import graph
from course_kit.ros.graph import quiet_node
from course_kit.ros.names import full_name, is_hidden
from course_kit.ros2cli.graph import Graph, TopicEndpoints, is_local_only, participant_sockets

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rclpy.context import Context
    from rclpy.topic_endpoint_info import TopicEndpointInfo

    from course_kit.ros2cli.graph import EndpointFacts

_DISCOVERY_TOPIC = "ros_discovery_info"  # each participant publishes its nodes here (rmw_dds_common)
_PARTICIPANT = 12  # first bytes of an endpoint's identifier, the same within one participant (DDSI-RTPS, 9.3.1)
_UNKNOWN = "_NODE_NAME_UNKNOWN_"
_LOOK_EVERY = 0.002
_QUIET = 0.02  # endpoints of one node arrive in one or two bursts, less than a millisecond apart
_NAMELESS = 1.0  # what has no node's name by then will not get one
_OPEN_DISCOVERY = 1.0  # beyond loopback nobody can tell who is still to answer
PATIENCE = 5.0
_QOS = (
    "reliability",
    "history",
    "depth",
    "durability",
    "lifespan",
    "deadline",
    "liveliness",
    "liveliness_lease_duration",
)


class Observer:
    """A node that only looks at the graph: it has no topics and services."""

    def __init__(self, context: Context, name: str, *, visits: bool = False) -> None:
        self._domain_id = context.get_domain_id()
        self._started = time.monotonic()
        self._local = is_local_only()
        self._found: frozenset[bytes] = frozenset()
        self._bound: frozenset[int] = frozenset()
        with visit_graph(visits):
            self._node = quiet_node(name, context)
        self.name = f"/{name}"

    def close(self) -> None:
        """Take the node off the graph."""
        self._node.destroy_node()

    def graph(self, patience: float = PATIENCE) -> Graph:
        """The graph once it has settled; what has been seen by then when that takes longer than `patience` seconds."""
        self._settle(time.monotonic() + patience)
        return self._read()

    def _settle(self, deadline: float) -> None:
        """Wait until every participant with a socket is known by its nodes and nothing has changed for a moment."""
        if self._nobody_came_or_left():
            return
        seen: object = None
        seen_at = 0.0
        while (now := time.monotonic()) < deadline:
            state = self._state()
            if state != seen:
                seen, seen_at = state, now
            elif now - seen_at >= _QUIET and self._is_complete(now, now - seen_at):
                return
            time.sleep(_LOOK_EVERY)

    def _nobody_came_or_left(self) -> bool:
        """Whether the last complete look still holds; known participants announce at once what they add."""
        return (
            bool(self._bound)
            and self._local
            and participant_sockets(self._domain_id) == self._bound
            and self._participants() == self._found
            and self._all_named()
        )

    def _state(self) -> object:
        node = self._node
        return (
            self._participants(),
            node.get_node_names_and_namespaces(),
            node.get_topic_names_and_types(no_demangle=True),
        )

    def _is_complete(self, now: float, quiet: float) -> bool:
        """Whether everybody is there, `quiet` seconds after the last change."""
        if not self._local:
            return now - self._started >= _OPEN_DISCOVERY and (self._all_named() or quiet >= _NAMELESS)
        bound, found = participant_sockets(self._domain_id), self._participants()
        # Counted from the last complete look: one that has just died may still be known, and must not stand
        # for one that has just come.
        arrived = len(found - self._found) >= len(bound - self._bound) and len(found) >= len(bound)
        if arrived and (self._all_named() or quiet >= _NAMELESS):
            self._found, self._bound = found, bound
            return True
        return False

    def _participants(self) -> frozenset[bytes]:
        infos = self._node.get_publishers_info_by_topic(_DISCOVERY_TOPIC, no_mangle=True)
        return frozenset(bytes(info.endpoint_gid[:_PARTICIPANT]) for info in infos)

    def _all_named(self) -> bool:
        """Whether each participant has named its nodes: names arrive after the endpoints."""
        if len(self._node.get_node_names_and_namespaces()) < len(self._participants()):
            return False
        named: dict[bool, set[bytes]] = {True: set(), False: set()}
        for topic, _ in self._node.get_topic_names_and_types(no_demangle=True):
            if topic != _DISCOVERY_TOPIC:
                ends = self._node.get_publishers_info_by_topic(topic, no_mangle=True)
                for info in (*ends, *self._node.get_subscriptions_info_by_topic(topic, no_mangle=True)):
                    named[info.node_name != _UNKNOWN].add(bytes(info.endpoint_gid[:_PARTICIPANT]))
        return named[False] <= named[True]

    def _read(self) -> Graph:
        node = self._node
        seen = graph.read_graph(node, plumbing=True)
        topics = dict(node.get_topic_names_and_types())
        hidden = [name for name in graph.node_names(node) if is_hidden(name)]  # a lab's has clients of all it has asked
        asked = Counter(use.channel for name in hidden for use in graph.uses_of(node, name, graph.CALLS))
        known = dict(node.get_service_names_and_types())
        counts = {name: (node.count_clients(name), node.count_services(name)) for name in known}
        services = {
            name: known[name] for name, (clients, servers) in counts.items() if servers or clients > asked[name]
        }
        return Graph(
            graph.Overview(
                tuple(node for node in seen.nodes if node != self.name),
                tuple(use for use in seen.uses if use.node != self.name),
            ),
            topics=topics,
            services=services,
            endpoints={topic: self._ends(topic) for topic in topics},
            counts=counts,
        )

    def _ends(self, topic: str) -> TopicEndpoints:
        publishers = self._node.get_publishers_info_by_topic(topic)
        subscriptions = self._node.get_subscriptions_info_by_topic(topic)
        return TopicEndpoints(*map(self._of_others, (publishers, subscriptions)))

    def _of_others(self, ends: list[TopicEndpointInfo]) -> list[EndpointFacts]:
        return [_plain(end) for end in ends if full_name(end.node_name, end.node_namespace) != self.name]


@contextmanager
def open_observer(
    context: Context | None = None, name: str | None = None, *, visits: bool = False
) -> Iterator[Observer]:
    """An Observer in `context`, or in a new one; it is gone afterwards."""
    import rclpy

    own = None
    if context is None:
        context = own = rclpy.Context()
        own.init([])
    try:
        looking = Observer(context, name or f"_ros2cli_{os.getpid()}", visits=visits)
        try:
            yield looking
        finally:
            looking.close()
    finally:
        if own is not None:
            own.try_shutdown()


def _plain(info: TopicEndpointInfo) -> EndpointFacts:
    qos = {name: getattr(info.qos_profile, name) for name in _QOS}
    return {
        "node_name": info.node_name,
        "node_namespace": info.node_namespace,
        "topic_type": info.topic_type,
        "topic_type_hash": str(info.topic_type_hash),
        "endpoint_gid": list(info.endpoint_gid),
        "qos_profile": {name: getattr(value, "nanoseconds", value) for name, value in qos.items()},
    }
