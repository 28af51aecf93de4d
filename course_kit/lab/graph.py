"""What the ROS graph shows, and what a missing or different name on it tells the learner."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, NamedTuple

from course_kit.lab.errors import ActionNotFoundError, LabError, ServiceNotFoundError
from course_kit.ros import graph
from course_kit.ros.names import is_hidden, is_of_every_node, nearest_name

if TYPE_CHECKING:
    from rclpy.node import Node

_SETTLING = 3.0  # seconds; a killed participant's lease lasts 2
_POLL = 0.01


class WantedServer(NamedTuple):
    """A server that was looked for."""

    role: graph.Role
    name: str
    type: str


def not_found(node: Node, wanted: WantedServer, waited: float, except_by: frozenset[str] = frozenset()) -> LabError:
    """The error that says why no such server was found, and what to do."""
    kind = ServiceNotFoundError if wanted.role == graph.SERVES else ActionNotFoundError
    return kind(_not_offered(node, wanted, waited, except_by))


def _not_offered(node: Node, wanted: WantedServer, waited: float, except_by: frozenset[str]) -> str:
    role, name, wanted_type = wanted
    offered = graph.offered_types(node, role, except_by)
    there = {one: types for one, types in offered.items() if not (is_of_every_node(one) or is_hidden(one))}
    types = there.get(name)
    if types and wanted_type not in types:
        asked = "you called it with" if role == graph.SERVES else "the goal was one of"
        return (
            f"{name} has the type {' and '.join(sorted(types))}, but {asked} {wanted_type}. "
            "Client and server must use the same type."
        )
    message = f"No node {role.verb} {name} (waited {waited:g} s). "
    if near := nearest_name(name, there):
        return f"{message}The nearest name on the graph is {near} [{', '.join(sorted(there[near]))}]."
    if there:
        return f"{message}On the graph: {', '.join(sorted(there)[:5])}."
    return f"{message}No {role.kind} at all is on the graph: has its server been started?"


def wait_for_nodes(node: Node, names: list[str], own: set[str], *, there: bool) -> None:
    """Wait until every node of these names is on the graph, or none is; 3 s at most."""
    deadline = time.monotonic() + _SETTLING
    pause = threading.Event()  # rclpy has no event for changes of the graph
    while time.monotonic() < deadline:
        seen = graph.node_names(node)
        counts = [seen.count(name) - (name in own) for name in names]
        if all(count > 0 for count in counts) if there else not any(count > 0 for count in counts):
            return
        pause.wait(_POLL)
