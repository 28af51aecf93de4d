"""The ROS graph at one moment, as this process has discovered it: which node offers what, and which one uses it.

`Node.get_service_names_and_types` lists clients' names as well, so the nodes are asked one by one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from course_kit.ros import names

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo


class Role(NamedTuple):
    """What a node does with a channel."""

    kind: str
    verb: str
    offers: bool
    inward: bool


SERVES = Role("service", "serves", offers=True, inward=True)
CALLS = Role("service", "calls", offers=False, inward=False)
RUNS = Role("action", "runs the action", offers=True, inward=True)
SENDS_GOALS = Role("action", "sends goals to", offers=False, inward=False)
PUBLISHES = Role("topic", "publishes", offers=True, inward=False)
LISTENS = Role("topic", "listens to", offers=False, inward=True)
ROLES = (SERVES, CALLS, RUNS, SENDS_GOALS, PUBLISHES, LISTENS)
KINDS = ("service", "action", "topic")
_MISSING = {"service": "No node serves", "action": "No node runs", "topic": "No node publishes"}
# So many of the first bytes of an endpoint's identifier are the same within one process, at least with Fast DDS
# (GuidUtils.hpp).
_PROCESS = 8
_FEEDBACK, _FEEDBACK_TYPE = "/_action/feedback", "_FeedbackMessage"


class ChannelUse(NamedTuple):
    """One node on one channel."""

    node: str
    role: Role
    channel: str
    types: tuple[str, ...]


class Overview(NamedTuple):
    """Nodes and what they do, in alphabetical order."""

    nodes: tuple[str, ...]
    uses: tuple[ChannelUse, ...]

    def uses_of(self, node: str) -> list[ChannelUse]:
        """What one node does."""
        return [use for use in self.uses if use.node == node]

    def channels(self) -> dict[tuple[str, str], list[ChannelUse]]:
        """Kind and name of each channel, with who is on it."""
        found: dict[tuple[str, str], list[ChannelUse]] = {}
        for use in self.uses:
            found.setdefault((use.role.kind, use.channel), []).append(use)
        return dict(sorted(found.items(), key=lambda item: (KINDS.index(item[0][0]), item[0][1])))

    def remarks(self) -> dict[tuple[str, str], list[str]]:
        """What may be amiss, sentences for kind and name of a channel: without the other side, or with two types."""
        found: dict[tuple[str, str], list[str]] = {}
        for (kind, name), uses in self.channels().items():
            if is_plumbing(uses[0]):
                continue
            types = sorted({kind for use in uses for kind in use.types})
            remarks = []
            if not any(use.role.offers for use in uses):
                remarks.append(f"{_MISSING[kind]} {name}.")
            elif kind == "topic" and all(use.role.offers for use in uses):
                remarks.append(f"No node listens to {name}.")
            if len(types) > 1:
                remarks.append(f"{name} is used with {len(types)} types, which never meet: {', '.join(types)}.")
            if remarks:
                found[kind, name] = remarks
        return found


def read_graph(node: Node, *, plumbing: bool = False, most: int | None = None) -> Overview:
    """The graph as a node sees it, or so many nodes of it."""
    visible = [name for name in node_names(node) if plumbing or not names.is_hidden(name)][:most]
    uses = {use for name in set(visible) for use in uses_of(node, name) if plumbing or not is_plumbing(use)}
    order = sorted(uses, key=lambda use: (use.node, KINDS.index(use.role.kind), not use.role.offers, use.channel))
    return Overview(tuple(visible), tuple(order))


def is_plumbing(use: ChannelUse) -> bool:
    """Whether ROS itself has made it."""
    if use.role.kind == "service" and names.is_of_every_node(use.channel):
        return True
    return names.is_hidden(use.channel) or names.is_of_ros(use.channel)


def process_of(end: TopicEndpointInfo) -> bytes:
    """What tells apart in which process an endpoint is; with another middleware than Fast DDS in which participant."""
    return bytes(end.endpoint_gid[:_PROCESS])


def node_names(node: Node) -> list[str]:
    """Full names of all nodes in alphabetical order; a name stands as often as nodes carry it."""
    return sorted(names.full_name(*pair) for pair in node.get_node_names_and_namespaces())


def count_servers(node: Node, kind: str, name: str) -> int:
    """How many servers a service or an action has."""
    return node.count_services(f"{name}{names.GOALS}" if kind == RUNS.kind else name)


def count_publishing(node: Node, topic: str) -> int:
    """How many nodes publish a topic; a lab publishes by a hidden one, which does not count."""
    found = node.get_publishers_info_by_topic(topic)
    visible = [end for end in found if not names.is_hidden(end.node_name)]
    return len({(end.node_namespace, end.node_name, process_of(end)) for end in visible})


def offered_types(node: Node, role: Role, except_by: frozenset[str] = frozenset()) -> dict[str, list[str]]:
    """What has a server or a publisher on the graph, with its types."""
    found: dict[str, list[str]] = {}
    for name in set(node_names(node)) - except_by:
        for use in uses_of(node, name, role):
            known = found.setdefault(use.channel, [])
            known += [kind for kind in use.types if kind not in known]
    return found


def uses_of(node: Node, full_name: str, *roles: Role) -> Iterator[ChannelUse]:
    """What a node does, as another node sees it; nothing more once it has gone."""
    from rclpy.impl.implementation_singleton import rclpy_implementation

    namespace, _, name = full_name.rpartition("/")
    where = (name, namespace or "/")
    readers: dict[Role, Callable[[], Iterable[tuple[str, list[str]]]]] = {
        SERVES: lambda: node.get_service_names_and_types_by_node(*where),
        CALLS: lambda: node.get_client_names_and_types_by_node(*where),
        RUNS: lambda: _actions(node.get_publisher_names_and_types_by_node(*where)),
        SENDS_GOALS: lambda: _actions(node.get_subscriber_names_and_types_by_node(*where)),
        PUBLISHES: lambda: node.get_publisher_names_and_types_by_node(*where),
        LISTENS: lambda: node.get_subscriber_names_and_types_by_node(*where),
    }
    for role in roles or readers:
        try:
            found = readers[role]()
        except (rclpy_implementation.RCLError, ValueError):  # it has gone meanwhile, or has no proper name yet
            return
        yield from (ChannelUse(full_name, role, channel, tuple(sorted(types))) for channel, types in found)


def _actions(topics: Iterable[tuple[str, list[str]]]) -> Iterator[tuple[str, list[str]]]:
    """The actions whose feedback is among topics, as rcl_action knows them; `rclpy.action` would import numpy."""
    for topic, types in topics:
        if topic.endswith(_FEEDBACK):
            ours = [kind.removesuffix(_FEEDBACK_TYPE) for kind in types if kind.endswith(_FEEDBACK_TYPE)]
            if ours:
                yield topic.removesuffix(_FEEDBACK), ours


def quiet_node(name: str, context: Context) -> Node:
    """A node with nothing on it: what nobody can call, nobody can call wrongly, and it costs nothing at each turn."""
    from rclpy.node import Node
    from rclpy.parameter import Parameter

    return Node(
        name,
        context=context,
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=False,
        # rclpy leaves this service on the graph when the node is destroyed but its context lives on.
        parameter_overrides=[Parameter("start_type_description_service", value=False)],
    )
