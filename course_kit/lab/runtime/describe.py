"""A node in words: its name, its class, and what it offers; the same each time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.ros.messages import type_name
from course_kit.ros.names import is_of_every_node, is_of_ros, short_name

if TYPE_CHECKING:
    from rclpy.node import Node


def describe_node(node: Node) -> str:
    """One line for the node and one for each service, action and topic it has made."""
    lines = [f"{short_name(node.get_fully_qualified_name())} ({type(node).__name__})"]
    lines += sorted(_services(node)) + sorted(_actions(node)) + sorted(_topics(node))
    return "\n    ".join(lines)


def channels_of(node: Node) -> set[str]:
    """The full names of the services and topics a node uses."""
    services = {one.service_name for kind in (node.services, node.clients) for one in kind}
    return services | {one.topic_name for kind in (node.publishers, node.subscriptions) for one in kind}


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


def _services(node: Node) -> set[str]:
    serves = {
        f"serves {service.service_name} [{type_name(service.srv_type)}]"
        for service in node.services
        if not is_of_every_node(service.service_name)
    }
    calls = {f"calls {client.service_name} [{type_name(client.srv_type)}]" for client in node.clients}
    return serves | calls


def _actions(node: Node) -> set[str]:
    from rclpy.action import get_action_client_names_and_types_by_node, get_action_server_names_and_types_by_node

    own = (node, node.get_name(), node.get_namespace())
    verbs = {
        "runs the action": get_action_server_names_and_types_by_node(*own),
        "sends goals to": get_action_client_names_and_types_by_node(*own),
    }
    return {f"{verb} {name} [{', '.join(types)}]" for verb, found in verbs.items() for name, types in found}


def _topics(node: Node) -> set[str]:
    sends = {
        f"publishes {publisher.topic_name} [{type_name(publisher.msg_type)}]"
        for publisher in node.publishers
        if not is_of_ros(publisher.topic_name)
    }
    takes = {
        f"listens to {subscription.topic_name} [{type_name(subscription.msg_type)}]"
        for subscription in node.subscriptions
        if not is_of_ros(subscription.topic_name)
    }
    return sends | takes
