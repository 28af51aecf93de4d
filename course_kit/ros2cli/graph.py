"""What is on the ROS graph at one moment, as plain data that verbs read and the daemon sends."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple, TypedDict

from course_kit import environment
from course_kit.environment import domains
from course_kit.ros.graph import ROLES, RUNS, SENDS_GOALS, ChannelUse, Overview
from course_kit.ros.names import is_hidden

if TYPE_CHECKING:
    from course_kit.ros.graph import Role

Names = dict[str, list[str]]  # name -> its types


class EndpointFacts(TypedDict):
    """A publisher or a subscription; durations in nanoseconds, the type's hash as REP 2011 writes it."""

    node_name: str
    node_namespace: str
    topic_type: str
    topic_type_hash: str
    endpoint_gid: list[int]
    qos_profile: dict[str, int]


class TopicEndpoints(NamedTuple):
    """Who is on a topic."""

    publishers: list[EndpointFacts]
    subscriptions: list[EndpointFacts]


class Graph(NamedTuple):
    """The graph without the node that looked at it."""

    overview: Overview
    topics: Names
    services: Names
    endpoints: dict[str, TopicEndpoints]
    counts: dict[str, tuple[int, int]]

    @classmethod
    def from_json(cls, reply: dict[str, Any]) -> Graph:
        """The reverse of `to_json`."""
        nodes, uses, topics, services, endpoints, counts = reply["graph"]
        overview = Overview(
            tuple(nodes), tuple(ChannelUse(node, ROLES[role], name, tuple(types)) for node, role, name, types in uses)
        )
        return cls(
            overview, topics, services, {name: TopicEndpoints(*ends) for name, ends in endpoints.items()}, counts
        )

    def to_json(self) -> dict[str, Any]:
        """Plain data for `json`."""
        nodes, uses = self.overview
        plain = [(use.node, ROLES.index(use.role), use.channel, use.types) for use in uses]
        return {"graph": [nodes, plain, self.topics, self.services, self.endpoints, self.counts]}

    @property
    def nodes(self) -> tuple[str, ...]:
        """Full names, one for each node: two nodes of the same name stand twice."""
        return self.overview.nodes

    def channels_of(self, node: str, role: Role) -> Names:
        """What a node does in a role, with its types."""
        return {use.channel: list(use.types) for use in self.overview.uses_of(node) if use.role == role}

    def actions(self) -> Names:
        """Action names with their types; what a notebook alone has asked for, maybe misspelt, is none."""
        found: Names = {}
        for use in self.overview.uses:
            if use.role == RUNS or (use.role == SENDS_GOALS and not is_hidden(use.node)):
                known = found.setdefault(use.channel, [])
                known += [kind for kind in use.types if kind not in known]
        return found

    def nodes_on(self, action: str, role: Role) -> Names:
        """The nodes that run an action, or send goals to it, with the types they use it with."""
        return {use.node: list(use.types) for use in self.overview.uses if (use.role, use.channel) == (role, action)}


def visible_names(names: Names, *, hidden_too: bool = False) -> Names:
    """`names` in order, without hidden ones unless wanted."""
    return {name: names[name] for name in sorted(names) if hidden_too or not is_hidden(name)}


def is_local_only() -> bool:
    """Whether everybody this process can meet has a socket in the tables of this machine."""
    return (
        environment.apply_settings().only_this_machine
        and not os.environ.get("ROS_STATIC_PEERS")
        and os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps")
        and not os.environ.get("ROS_DISCOVERY_SERVER")
        and domains.can_read_ports()
    )


def participant_sockets(domain_id: int) -> frozenset[int]:
    """The inodes of the discovery sockets bound in `domain_id`, one for each participant, this process's included."""
    wanted = domains.discovery_ports(domain_id)
    return frozenset(inode for number, inode in domains.bound_ports() if number in wanted)
