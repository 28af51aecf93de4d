"""Names on the graph: put together, taken apart, and the one that was probably meant.

See "Topic and service names" in the ROS 2 design articles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rclpy.node import Node

GOALS = "/_action/send_goal"  # where an action takes goals, after its name
# Every node has these services and topics; they are nobody's answer to a misspelt name.
_SERVICES_OF_EVERY_NODE = frozenset(
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
_TOPICS_OF_ROS = frozenset({"/parameter_events", "/rosout", "/clock"})
_ALIKE = 0.55  # difflib's ratio of two names of which one may have been meant for the other; 1.0 is the same
_LONGEST = 100  # characters of names that are compared: it takes the product of their lengths


def full_name(name: str, namespace: str) -> str:
    """A node's fully qualified name."""
    return f"{namespace.rstrip('/')}/{name}"


def from_root(name: str) -> str:
    """A name as the graph has it; a relative one counts from the root namespace."""
    return name if name.startswith("/") else f"/{name}"


def short_name(node: str) -> str:
    """A node's name as a person writes it: without the slash of the root namespace."""
    return node[1:] if node.startswith("/") and node.count("/") == 1 else node


def full_action_name(node: Node, action: str) -> str:
    """An action's full name, as a node sees it; its services are renamed with it."""
    return str(node.resolve_service_name(action + GOALS)).removesuffix(GOALS)


def is_hidden(name: str) -> bool:
    """Whether a part of a name begins with an underscore, such as those of an action's own topics."""
    return any(part.startswith("_") for part in name.split("/"))


def is_of_every_node(service: str) -> bool:
    """Whether a service is one that each node has, such as /talker/get_parameters."""
    return service.rpartition("/")[2] in _SERVICES_OF_EVERY_NODE


def is_of_ros(topic: str) -> bool:
    """Whether a topic is one that ROS itself keeps, such as /rosout."""
    return topic in _TOPICS_OF_ROS


def nearest_name(wanted: str, names: Iterable[str], alike: float = _ALIKE) -> str | None:
    """The name that was probably meant: the same last part in another namespace, or a spelling near it."""
    from course_kit.interfaces.hints import nearest_name as nearest_spelling  # only when something is wrong

    if len(wanted) > _LONGEST:
        return None
    by_last_part: dict[str, str] = {}
    candidates = sorted(name for name in set(names) - {wanted} if len(name) <= _LONGEST)
    for name in candidates:
        by_last_part.setdefault(name.rpartition("/")[2], name)
    last = wanted.rpartition("/")[2]
    if last in by_last_part:
        return by_last_part[last]
    if near := nearest_spelling(wanted, candidates, alike):
        return near
    return by_last_part.get(nearest_spelling(last, by_last_part, alike) or "")


def did_you_mean(wanted: str, names: Iterable[str]) -> str:
    """' Did you mean ...?' with the nearest of `names`, or '' when none is near; ready to be appended."""
    near = nearest_name(wanted, names)
    return f" Did you mean {near}?" if near else ""
