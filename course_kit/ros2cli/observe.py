"""Looks at the graph through a node of this process, and knows when it has seen all of it."""

from __future__ import annotations

import os
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from course_kit.ros import compat, compat_names
from course_kit.ros.names import full_name
from course_kit.ros2cli import sockets
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.graph import Entities, Graph

if TYPE_CHECKING:
    from collections.abc import Iterator

_DISCOVERY_TOPIC = "ros_discovery_info"  # each participant publishes its nodes here (rmw_dds_common)
_UNKNOWN = "_NODE_NAME_UNKNOWN_"
_GUID_PREFIX = 12  # bytes of an endpoint's identifier that name its participant
_LOOK_EVERY = 0.002
_QUIET = 0.02  # endpoints of one node arrive in one or two bursts, less than a millisecond apart
_NAMELESS = 1.0  # what has no node's name by then will not get one
_OPEN_DISCOVERY = 1.0  # beyond loopback nobody can tell who is still to answer
PATIENCE = 5.0


class Observer:
    """A node without topics and services of its own that looks at the graph.

    Args:
        context: an initialised rclpy context; its participant is what sees the graph.
        name: the node's name; hidden, so with a leading underscore.

    Raises:
        CommandError: this rclpy does not let itself be asked.
    """

    def __init__(self, context: Any, name: str) -> None:
        found = compat.check([compat_names.GRAPH])
        if not found.has(compat_names.GRAPH):
            raise CommandError(" ".join(found.sentences()))
        from rclpy.impl.implementation_singleton import rclpy_implementation

        self._rcl = rclpy_implementation
        self._domain_id = context.get_domain_id()
        self._started = time.monotonic()
        self._local = sockets.is_local_only()
        self._found: frozenset[bytes] = frozenset()
        self._bound: frozenset[int] = frozenset()
        with context.handle:
            self._node = rclpy_implementation.Node(name, "/", context.handle, [], False, False)
        self.name = f"/{name}"

    def close(self) -> None:
        """Take the node off the graph."""
        self._node.destroy_when_not_in_use()

    def graph(self, patience: float = PATIENCE) -> Graph:
        """The graph once it has settled; what has been seen by then when that takes longer than `patience` seconds."""
        with self._node:
            self._settle(time.monotonic() + patience)
            return self._read()

    def _settle(self, deadline: float) -> None:
        """Wait until every participant with a socket is known by its nodes and nothing has changed for a moment.

        rclpy has no event for changes of the graph, so it is looked at in short steps, up to `deadline`.
        """
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
        """Whether the last complete look still holds; what those who are known add is told by them at once."""
        return (
            bool(self._bound)
            and self._local
            and sockets.participants(self._domain_id) == self._bound
            and self._participants() == self._found
            and self._all_named()
        )

    def _state(self) -> object:
        node = self._node
        return (
            self._participants(),
            node.get_node_names_and_namespaces(),
            self._rcl.rclpy_get_topic_names_and_types(node, True),
        )

    def _is_complete(self, now: float, quiet: float) -> bool:
        """Whether everybody is there, `quiet` seconds after the last change."""
        if not self._local:
            return now - self._started >= _OPEN_DISCOVERY and (self._all_named() or quiet >= _NAMELESS)
        bound, found = sockets.participants(self._domain_id), self._participants()
        # Counted from the last complete look: one that has just died may still be known, and must not stand
        # for one that has just come.
        arrived = len(found - self._found) >= len(bound - self._bound) and len(found) >= len(bound)
        if arrived and (self._all_named() or quiet >= _NAMELESS):
            self._found, self._bound = found, bound
            return True
        return False

    def _participants(self) -> frozenset[bytes]:
        infos = self._rcl.rclpy_get_publishers_info_by_topic(self._node, _DISCOVERY_TOPIC, True)
        return frozenset(_participant_of(info) for info in infos)

    def _all_named(self) -> bool:
        """Whether each participant has told its nodes: names arrive after the endpoints.

        Single endpoints without a node may stay: rclpy leaves a service behind when it destroys a node.
        """
        if len(self._node.get_node_names_and_namespaces()) < len(self._participants()):
            return False
        named: dict[bool, set[bytes]] = {True: set(), False: set()}
        for topic, _ in self._rcl.rclpy_get_topic_names_and_types(self._node, True):
            if topic != _DISCOVERY_TOPIC:
                for info in self._both_ends(topic):
                    named[info["node_name"] != _UNKNOWN].add(_participant_of(info))
        return named[False] <= named[True]

    def _both_ends(self, topic: str) -> Iterator[dict[str, Any]]:
        yield from self._rcl.rclpy_get_publishers_info_by_topic(self._node, topic, True)
        yield from self._rcl.rclpy_get_subscriptions_info_by_topic(self._node, topic, True)

    def _read(self) -> Graph:
        rcl, node = self._rcl, self._node
        pairs = [(n, ns) for n, ns in node.get_node_names_and_namespaces() if full_name(n, ns) != self.name]
        topics = dict(rcl.rclpy_get_topic_names_and_types(node, False))
        services = dict(rcl.rclpy_get_service_names_and_types(node))
        return Graph(
            nodes=[full_name(name, namespace) for name, namespace in pairs],
            topics=topics,
            services=services,
            entities={full_name(name, namespace): self._entities(name, namespace) for name, namespace in pairs},
            endpoints={topic: self._endpoints(topic) for topic in topics},
            counts={name: (node.get_count_clients(name), node.get_count_services(name)) for name in services},
        )

    def _entities(self, name: str, namespace: str) -> Entities:
        rcl, node = self._rcl, self._node
        try:
            return Entities(
                dict(rcl.rclpy_get_subscriber_names_and_types_by_node(node, False, name, namespace)),
                dict(rcl.rclpy_get_publisher_names_and_types_by_node(node, False, name, namespace)),
                dict(rcl.rclpy_get_service_names_and_types_by_node(node, name, namespace)),
                dict(rcl.rclpy_get_client_names_and_types_by_node(node, name, namespace)),
            )
        except rcl.NodeNameNonExistentError:  # it has left since it was listed
            return Entities({}, {}, {}, {})

    def _endpoints(self, topic: str) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
        publishers = self._rcl.rclpy_get_publishers_info_by_topic(self._node, topic, False)
        subscriptions = self._rcl.rclpy_get_subscriptions_info_by_topic(self._node, topic, False)
        return [_plain(info) for info in publishers], [_plain(info) for info in subscriptions]


@contextmanager
def observer(context: Any = None, name: str | None = None) -> Iterator[Observer]:
    """An Observer in `context`, or in one of its own; it is gone afterwards."""
    import rclpy

    own = context is None
    if own:
        context = rclpy.Context()
        context.init([])
    try:
        looking = Observer(context, name or f"_ros2cli_{os.getpid()}")
        try:
            yield looking
        finally:
            looking.close()
    finally:
        if own:
            context.try_shutdown()


def _participant_of(info: dict[str, Any]) -> bytes:
    return bytes(info["endpoint_gid"][:_GUID_PREFIX])


def _plain(info: dict[str, Any]) -> dict[str, Any]:
    """An endpoint as `json` can send it: durations in nanoseconds, the type's hash as REP 2011 writes it."""
    qos = {name: getattr(value, "nanoseconds", value) for name, value in info["qos_profile"].items()}
    type_hash = info["topic_type_hash"]
    return {
        **info,
        "qos_profile": qos,
        "topic_type_hash": f"RIHS{type_hash['version']:02}_{type_hash['value'].hex()}",
    }
