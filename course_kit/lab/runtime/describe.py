"""A node in words: its name, its class, and what it offers; the same each time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.ros import graph
from course_kit.ros.names import is_hidden, is_of_every_node, is_of_ros, short_name

if TYPE_CHECKING:
    from rclpy.node import Node


def describe_node(node: Node) -> str:
    """One line for the node and one for each service, action and topic it has made."""
    name = node.get_fully_qualified_name()
    uses = [use for use in graph.uses_of(node, name) if not _is_of_ros(use)]
    uses.sort(key=lambda use: (graph.KINDS.index(use.role.kind), use.role.verb, use.channel))
    lines = [f"{use.role.verb} {use.channel} [{', '.join(use.types)}]" for use in uses]
    return "\n    ".join([f"{short_name(name)} ({type(node).__name__})", *lines])


def _is_of_ros(use: graph.ChannelUse) -> bool:
    if is_hidden(use.channel) or is_of_ros(use.channel):
        return True
    return use.role == graph.SERVES and is_of_every_node(use.channel)


def channels_of(node: Node) -> set[str]:
    """The full names of the services and topics a node uses."""
    services = {end.service_name for kind in (node.services, node.clients) for end in kind}
    return services | {end.topic_name for kind in (node.publishers, node.subscriptions) for end in kind}


def actions_of(node: Node) -> set[str]:
    """The full names of the actions a node runs."""
    from rclpy.action import get_action_server_names_and_types_by_node

    return {name for name, _ in get_action_server_names_and_types_by_node(node, node.get_name(), node.get_namespace())}


def is_alive(node: Node) -> bool:
    """Whether a node has not been destroyed."""
    from rclpy.exceptions import InvalidHandle

    try:
        with node.handle:
            return True
    except (InvalidHandle, AttributeError):
        return False
