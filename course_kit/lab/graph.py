"""What the ROS graph shows, and what a missing or different name on it tells the learner."""

from __future__ import annotations

import contextlib
import difflib
import threading
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

_SETTLING = 3.0  # seconds; a killed participant's lease lasts 2
_POLL = 0.01
# Every node has these; they are nobody's answer to a misspelt name.
_OF_EVERY_NODE = frozenset(
    {
        "describe_parameters",
        "get_parameter_types",
        "get_parameters",
        "get_type_description",
        "list_parameters",
        "set_parameters",
        "set_parameters_atomically",
    }
)
_OF_ROS = frozenset({"/parameter_events", "/rosout", "/clock"})  # topics


def served(node: Any, except_by: frozenset[str] = frozenset()) -> dict[str, list[str]]:
    """Services that have a server on the graph, with their types; those of the nodes `except_by` are left out.

    `Node.get_service_names_and_types` lists clients' names as well, so the nodes are asked one by one.
    """
    found: dict[str, list[str]] = {}
    for name, namespace in set(node.get_node_names_and_namespaces()):
        if full_name(name, namespace) in except_by:
            continue
        for service, types in _of_node(node, name, namespace):
            if not is_of_every_node(service) and not is_hidden(service):
                found.setdefault(service, []).extend(kind for kind in types if kind not in found.get(service, []))
    return found


def is_of_every_node(service: str) -> bool:
    """Whether a service is one that each node has, such as /talker/get_parameters."""
    return service.rpartition("/")[2] in _OF_EVERY_NODE


def is_of_ros(topic: str) -> bool:
    """Whether a topic is one that ROS itself keeps, such as /rosout."""
    return topic in _OF_ROS


def is_hidden(name: str) -> bool:
    """Whether a part of a name begins with an underscore, such as those of an action's own topics."""
    return "/_" in name


def full_name(name: str, namespace: str) -> str:
    """A node's fully qualified name."""
    return f"{namespace.rstrip('/')}/{name}"


def full_action_name(node: Any, action: str) -> str:
    """An action's full name, as a node sees it; its services are renamed with it."""
    goals = "/_action/send_goal"
    return str(node.resolve_service_name(action + goals)).removesuffix(goals)


def nearest(wanted: str, names: Iterable[str]) -> str | None:
    """The name most like the wanted one: the same last part in another namespace, or a spelling near it."""
    candidates = sorted(names)
    last = wanted.rpartition("/")[2]
    for name in candidates:
        if name.rpartition("/")[2] == last:
            return name
    near = difflib.get_close_matches(wanted, candidates, n=1, cutoff=0.5)
    return near[0] if near else None


def no_service(node: Any, service: str, wanted_type: str, waited: float, except_by: frozenset[str]) -> str:
    """Why no server of this name and type was found, and what to do."""
    services = served(node, except_by)
    types = services.get(service)
    if types and wanted_type not in types:
        return (
            f"{service} has the type {' and '.join(sorted(types))}, but you called it with {wanted_type}. "
            "Client and server must use the same type."
        )
    message = f"No node serves {service} (waited {waited:g} s). "
    return message + _instead(service, services, "service")


def no_action(node: Any, action: str, wanted_type: str, waited: float) -> str:
    """Why no action server of this name and type was found, and what to do."""
    actions = actions_run(node)
    types = actions.get(action)
    if types and wanted_type not in types:
        return (
            f"{action} has the type {' and '.join(sorted(types))}, but the goal was one of {wanted_type}. "
            "Client and server must use the same type."
        )
    message = f"No node runs the action {action} (waited {waited:g} s). "
    return message + _instead(action, actions, "action")


def _instead(name: str, there: dict[str, list[str]], kind: str) -> str:
    """What is on the graph when a name is not, of those of its kind with their types."""
    near = nearest(name, there)
    if near:
        return f"The nearest name on the graph is {near} [{', '.join(sorted(there[near]))}]."
    if there:
        return f"On the graph: {', '.join(sorted(there)[:5])}."
    return f"No {kind} at all is on the graph: has its server been started?"


def actions_run(node: Any) -> dict[str, list[str]]:
    """Actions that have a server on the graph, with their types."""
    from rclpy.action import get_action_server_names_and_types_by_node
    from rclpy.node import NodeNameNonExistentError

    found: dict[str, list[str]] = {}
    for name, namespace in set(node.get_node_names_and_namespaces()):
        with contextlib.suppress(NodeNameNonExistentError):  # it has gone meanwhile
            for action, types in get_action_server_names_and_types_by_node(node, name, namespace):
                found.setdefault(action, []).extend(kind for kind in types if kind not in found.get(action, []))
    return found


def wait_for_nodes(node: Any, names: list[str], own: set[str], *, there: bool) -> None:
    """Wait until every node of these names is on the graph, or none is; 3 s at most.

    Args:
        node: looks at the graph.
        names: fully qualified names.
        own: names of nodes in this process, of which one each does not count.
        there: what to wait for.
    """
    deadline = time.monotonic() + _SETTLING
    pause = threading.Event()  # rclpy has no event for changes of the graph
    while time.monotonic() < deadline:
        seen = [full_name(*one) for one in node.get_node_names_and_namespaces()]
        counts = [seen.count(name) - (name in own) for name in names]
        if all(count > 0 for count in counts) if there else not any(count > 0 for count in counts):
            return
        pause.wait(_POLL)


def _of_node(node: Any, name: str, namespace: str) -> list[tuple[str, list[str]]]:
    from rclpy.node import NodeNameNonExistentError

    try:
        return list(node.get_service_names_and_types_by_node(name, namespace))
    except NodeNameNonExistentError:  # it has gone meanwhile
        return []
