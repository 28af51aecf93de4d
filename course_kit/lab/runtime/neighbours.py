"""Other notebooks on the same graph: what each runs, and the request that it stop that.

ROS does not tell whose a node is. So each lab announces its nodes and those of its scripts on a hidden topic, where who
comes later hears it as well, and listens to another one for the request to stop them. What nobody has announced belongs
to some other program.
"""

from __future__ import annotations

import json
import threading
import time
from typing import TYPE_CHECKING, NamedTuple

from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from course_kit.ros import graph
from course_kit.ros.names import full_name
from course_kit.ros.topic import NO_PUBLISHER_EVENTS, NO_SUBSCRIPTION_EVENTS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rclpy.node import Node

    from course_kit.ros.messages import Message

NODES_TOPIC, STOP_TOPIC = "/_lab/nodes", "/_lab/stop"
# Without ROS's prefix on the name, so that no `ros2 topic list` shows a learner what no lesson speaks of.
_KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, avoid_ros_namespace_conventions=True)
# A reader's depth is for all writers together: with 1 a notebook's own word would take the place of another's.
_HEARD = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL, avoid_ros_namespace_conventions=True)
_PASSING = QoSProfile(depth=10, avoid_ros_namespace_conventions=True)
_STOPPING = 8.0  # seconds another notebook is given: its scripts have 4 to end, and a callback may run
_POLL = 0.02
_OF_EVERY_NODE = "/parameter_events"


class OtherNotebook(NamedTuple):
    """Another notebook, or a program with a lab, that has nodes on this graph."""

    title: str
    nodes: tuple[str, ...]
    key: str

    def __str__(self) -> str:
        return f"{self.title}: {', '.join(name.lstrip('/') for name in self.nodes)}"


class Neighbours:
    """What one lab knows of the others."""

    def __init__(self, node: Node, title: str, stop: Callable[[str], None]) -> None:
        self._node = node
        self._key = node.get_fully_qualified_name()
        self._title = title
        self._stop = stop
        self._heard: dict[str, OtherNotebook] = {}
        self._asked: set[tuple[graph.Role, str]] = set()
        self._announced: list[str] | None = None
        self._nodes_out = node.create_publisher(String, NODES_TOPIC, _KEPT, event_callbacks=NO_PUBLISHER_EVENTS)
        self._stop_out = node.create_publisher(String, STOP_TOPIC, _PASSING, event_callbacks=NO_PUBLISHER_EVENTS)
        for topic, hear, qos in ((NODES_TOPIC, self._hear, _HEARD), (STOP_TOPIC, self._hear_stop, _PASSING)):
            node.create_subscription(String, topic, hear, qos, event_callbacks=NO_SUBSCRIPTION_EVENTS)

    def announce(self, nodes: Iterable[str]) -> None:
        """Tell the others which nodes this notebook has now."""
        names = sorted(nodes)
        if names == self._announced:
            return
        self._announced = names
        self._asked.clear()
        self._nodes_out.publish(String(data=json.dumps({"key": self._key, "title": self._title, "nodes": names})))

    def others(self) -> list[OtherNotebook]:
        """The other notebooks that have nodes, by title."""
        if not self._heard:
            return []
        there = set(graph.nodes(self._node))  # one that was killed said nothing
        found = [one for one in list(self._heard.values()) if one.key in there and one.nodes]
        return sorted(found, key=lambda one: one.title)

    def may_announce(self, node: str) -> bool:
        """Whether a node is in one process with the lab of some other notebook, which will announce it."""
        labs = self._node.get_publishers_info_by_topic(NODES_TOPIC, no_mangle=True)
        ends = self._node.get_publishers_info_by_topic(_OF_EVERY_NODE)
        others = {graph.process_of(lab) for lab in labs if full_name(lab.node_name, lab.node_namespace) != self._key}
        of_node = {graph.process_of(end) for end in ends if full_name(end.node_name, end.node_namespace) == node}
        return bool(others & of_node)

    def answering(self, role: graph.Role, name: str) -> str:
        """Whose server answers where none of this notebook does; told once, until some notebook has other nodes."""
        if not self._heard or (role, name) in self._asked:
            return ""
        self._asked.add((role, name))
        whose = {node: other.title for other in self.others() for node in other.nodes}
        if any(self._offers(node, role, name) for node in self._announced or ()):
            return ""
        return next((f"{node.lstrip('/')} of {whose[node]}" for node in whose if self._offers(node, role, name)), "")

    def _offers(self, node: str, role: graph.Role, name: str) -> bool:
        return any(use.channel == name for use in graph.uses_of(self._node, node, role))

    def stop(self, others: list[OtherNotebook]) -> list[OtherNotebook]:
        """Have others stop their nodes, and wait until they have."""
        keys = {one.key for one in others}
        for key in keys:
            self._stop_out.publish(String(data=json.dumps({"key": key, "by": self._title})))
        deadline = time.monotonic() + _STOPPING
        pause = threading.Event()  # what is heard comes on another thread, and the graph has no event to wait for
        while (left := [one for one in self.others() if one.key in keys]) and time.monotonic() < deadline:
            pause.wait(_POLL)
        return left

    def _hear(self, message: Message) -> None:
        try:
            told = json.loads(message.data)
            one = OtherNotebook(str(told["title"]), tuple(map(str, told["nodes"])), str(told["key"]))
        except (ValueError, KeyError, TypeError):  # no lab has written it
            return
        if one.key != self._key:
            self._heard[one.key] = one
            self._asked.clear()

    def _hear_stop(self, message: Message) -> None:
        try:
            told = json.loads(message.data)
            key, by = told["key"], str(told["by"])
        except (ValueError, KeyError, TypeError):
            return
        if key == self._key:  # ending scripts takes seconds, in which callbacks go on
            threading.Thread(target=self._stop, args=(by,), name="lab-stop", daemon=True).start()
