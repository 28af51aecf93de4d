"""Other notebooks on the graph: what they run, what answers in place of this one's nodes, and how to stop it.

ROS does not tell whose a node is. So each lab's hidden node, and a node of each of its scripts, has a publisher on a
hidden topic whose name tells the notebook. A node is that notebook's whose mark comes out of the same process.
"""

from __future__ import annotations

import itertools
import os
import threading
import time
from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from rclpy.qos import QoSProfile
from std_msgs.msg import String

from course_kit.lab.runtime.describe import actions_of
from course_kit.ros import graph
from course_kit.ros.names import full_name, is_of_every_node, short_name
from course_kit.ros.topic import NO_PUBLISHER_EVENTS, NO_SUBSCRIPTION_EVENTS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rclpy.node import Node
    from rclpy.publisher import Publisher

    from course_kit.lab.runtime.engine import Engine
    from course_kit.lab.runtime.nodes import LiveNode
    from course_kit.ros.messages import Message

MARK_VARIABLE = "COURSE_KIT_LAB_MARK"  # in the environment of scripts
_SCRIPT, _NOTEBOOK = "s", "t"  # whose mark it is; the notebook's own comes last
_MARK, _STOP = "/_lab/of/", "/_lab/stop"
# Without ROS's prefix on the name, so that no `ros2 topic list` shows a learner what no lesson speaks of.
_HIDDEN = QoSProfile(depth=10, avoid_ros_namespace_conventions=True)
_OF_EVERY_NODE = "/parameter_events"
_LONGEST = 60  # bytes of a title
_STOPPING = 8.0  # seconds another notebook is given: its scripts have 4 to end, and a callback may run
_POLL = 0.02
_DISCOVERY, _QUIET = 1.0, 0.3  # seconds until nodes of this machine are known, and from one look to the next
_REMEDY = "lab.stop_others() stops what other notebooks run."


class OtherNotebook(NamedTuple):
    """Another notebook, or a program with a lab, that has nodes on this graph."""

    title: str  # the notebook's file, such as "02_actions.ipynb"
    nodes: tuple[str, ...]  # their full names, those of its scripts included
    key: str  # by which it is asked to stop

    def __str__(self) -> str:
        return f"{self.title}: {', '.join(name.lstrip('/') for name in self.nodes)}"


def mark_of(title: str, kind: str = _SCRIPT) -> str:
    """The topic by which other notebooks know those processes of this one."""
    return f"{_MARK}p{os.getpid()}/{kind}{title.encode()[:_LONGEST].hex()}"


def mark_as(topic: str, node: Node) -> Publisher:
    """Have the nodes in the process of `node` be known as a notebook's."""
    return node.create_publisher(String, topic, _HIDDEN, event_callbacks=NO_PUBLISHER_EVENTS)


class Neighbours:
    """Tells the learner what other notebooks have to do with this one's nodes."""

    def __init__(
        self, lab: Engine, title: str, on_stop: Callable[[str], None], script_nodes: Callable[[], dict[str, str]]
    ) -> None:
        """Begin; `on_stop` is called on its own thread, `script_nodes` says which script has which node."""
        self._on_stop, self._script_nodes = on_stop, script_nodes
        self._key = f"{_MARK}p{os.getpid()}"
        self._lab, self._node, self._title = lab, lab.node, title
        self._known_at = time.monotonic() + _DISCOVERY
        self._mark = mark_as(mark_of(title, _NOTEBOOK), self._node)
        self._stop_out = self._node.create_publisher(String, _STOP, _HIDDEN, event_callbacks=NO_PUBLISHER_EVENTS)
        self._node.create_subscription(String, _STOP, self._hear_stop, _HIDDEN, event_callbacks=NO_SUBSCRIPTION_EVENTS)

    def rename(self, title: str) -> None:
        """Be known by another title from now on."""
        self._node.destroy_publisher(self._mark)
        self._title, self._mark = title, mark_as(mark_of(title, _NOTEBOOK), self._node)

    def others(self) -> list[OtherNotebook]:
        """The other notebooks that have nodes, by title."""
        topics = [name for name, _ in self._node.get_topic_names_and_types(no_demangle=True)]
        marks = [name.rpartition("/") for name in sorted(topics) if name.startswith(_MARK)]
        # A script's title is the one at its start.
        titles = {key: bytes.fromhex(mark[1:]).decode(errors="ignore") for key, _, mark in marks if key != self._key}
        if not titles:
            return []
        marked = {
            graph.process_of(end): mark[0]
            for mark in marks
            for end in self._node.get_publishers_info_by_topic("".join(mark), no_mangle=True)
        }
        nodes: dict[str, set[str]] = {}
        for end in self._node.get_publishers_info_by_topic(_OF_EVERY_NODE):
            key = marked.get(graph.process_of(end))
            if key in titles and not end.node_name.startswith("_"):
                nodes.setdefault(key, set()).add(full_name(end.node_name, end.node_namespace))
        return sorted(OtherNotebook(titles[key], tuple(sorted(names)), key) for key, names in nodes.items())

    def settled_others(self) -> list[OtherNotebook]:
        """As `others`; a lab that has just joined the graph, and hears of it by and by, waits, but in no callback."""
        before, found = list[OtherNotebook](), self.others()
        while (not found or found != before) and time.monotonic() < self._known_at and not self._lab.in_callback():
            threading.Event().wait(_QUIET)  # the graph has no event to wait for
            before, found = found, self.others()
        return found

    def stop(self, others: list[OtherNotebook]) -> list[OtherNotebook]:
        """Have others stop their nodes; returns those that have not within some seconds."""
        keys = {other.key for other in others}
        for key in keys:
            self._stop_out.publish(String(data=f"{key} {self._title}"))
        deadline = time.monotonic() + _STOPPING
        pause = threading.Event()  # the graph has no event to wait for
        while (left := [other for other in self.others() if other.key in keys]) and time.monotonic() < deadline:
            pause.wait(_POLL)
        return left

    def _hear_stop(self, message: Message) -> None:
        key, _, by = message.data.partition(" ")
        if key == self._key:  # ending scripts takes seconds, in which callbacks go on
            threading.Thread(target=self._on_stop, args=(by,), name="lab-stop", daemon=True).start()

    def tell_who_answers(self, role: graph.Role, name: str) -> None:
        """Say so once where another notebook's node answers, in place of one that this one has forgotten to start."""
        whose = {node: other.title for other in self.others() for node in other.nodes}
        if not whose or any(self._offers(node, role, name) for node in self._script_nodes()):
            return
        node = next((node for node in whose if self._offers(node, role, name)), "")
        if node:
            self._lab.note_once(
                f"{name} is answered by {node.lstrip('/')} of {whose[node]}, not by a node of this notebook. {_REMEDY}"
            )

    def node_started(self, started: Iterable[LiveNode] = ()) -> None:
        """A node was started: what do another notebook, or a script of this one, offer as well? Of these each time."""
        newest = {offer for live in started for offer in _offered_by(live)}
        for name, role in list(self._find_doubled()):
            note = self._lab.note if (name, role) in newest else self._lab.note_once
            for node in self._list_offering(name, role):
                self._tell(node, f"{name} is also offered by {{}}: both answer every request.", note)

    def _tell(self, node: str, sentence: str, note: Callable[[str], None]) -> None:
        """Say it with whose node it is, and what stops it; one that is no notebook's may have been killed just now."""
        short = short_name(node)
        if script := self._script_nodes().get(node):
            self._lab.note(f"{sentence.format(f'{short} of your script {script}')} %ros_stop {script} stops it.")
        elif title := next((other.title for other in self.others() if node in other.nodes), ""):
            note(f"{sentence.format(f'{short} of {title}')} {_REMEDY}")

    def _find_doubled(self) -> Iterable[tuple[str, graph.Role]]:
        for (name, role), count in Counter(itertools.chain(*map(_offered_by, self._lab.nodes.live))).items():
            if graph.count_servers(self._node, role.kind, name) > count:
                yield name, role

    def _list_offering(self, name: str, role: graph.Role) -> list[str]:
        own = {live.name for live in self._lab.nodes.live} | self._lab.own_names
        found = [node for node in sorted(set(graph.node_names(self._node)) - own) if self._offers(node, role, name)]
        return found or sorted(own & {node for other in self.others() for node in other.nodes})

    def _offers(self, node: str, role: graph.Role, name: str) -> bool:
        return any(use.channel == name for use in graph.uses_of(self._node, node, role))


def _offered_by(live: LiveNode) -> Iterable[tuple[str, graph.Role]]:
    for node in live.made:
        for service in node.services:
            if not is_of_every_node(service.service_name):
                yield service.service_name, graph.SERVES
        for action in actions_of(node):
            yield action, graph.RUNS
