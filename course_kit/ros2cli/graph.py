"""What is on the ROS graph at one moment, as plain data that verbs read and the daemon sends."""

from __future__ import annotations

from typing import Any, NamedTuple

from course_kit.ros.names import is_hidden

Names = dict[str, list[str]]  # name -> its types

_ACTION_FEEDBACK = "/_action/feedback"
_FEEDBACK_TYPE = "_FeedbackMessage"


class Entities(NamedTuple):
    """What one node has; each is a mapping of names to types."""

    subscribers: Names
    publishers: Names
    servers: Names
    clients: Names


class Graph(NamedTuple):
    """The graph without the node that looked at it.

    Attributes:
        nodes: full names, one for each node: two nodes of the same name stand twice.
        topics: topic names with their types.
        services: service names with their types.
        entities: full node name to what the node has.
        endpoints: topic to its publishers and subscriptions, each a mapping as rclpy gives it.
        counts: service to its number of clients and of servers.
    """

    nodes: list[str]
    topics: Names
    services: Names
    entities: dict[str, Entities]
    endpoints: dict[str, tuple[list[dict[str, Any]], list[dict[str, Any]]]]
    counts: dict[str, tuple[int, int]]

    @classmethod
    def empty(cls) -> Graph:
        """A graph with nobody on it."""
        return cls([], {}, {}, {}, {}, {})

    @classmethod
    def from_json(cls, fields: dict[str, Any]) -> Graph:
        """The reverse of `to_json`."""
        entities = {node: Entities(*parts) for node, parts in fields.pop("entities").items()}
        return cls(entities=entities, **fields)

    def to_json(self) -> dict[str, Any]:
        """Plain data for `json`."""
        return self._asdict()

    def actions(self) -> Names:
        """Action names with their types, told by the feedback topics ("Actions" in the ROS 2 design articles)."""
        return actions_among(self.topics)

    def action_clients(self, action: str) -> dict[str, list[str]]:
        """Node to the types it uses `action` with."""
        return {
            node: found[action]
            for node, has in self.entities.items()
            if action in (found := actions_among(has.subscribers))
        }

    def action_servers(self, action: str) -> dict[str, list[str]]:
        """Node to the types it serves `action` with."""
        return {
            node: found[action]
            for node, has in self.entities.items()
            if action in (found := actions_among(has.publishers))
        }


def actions_among(topics: Names) -> Names:
    """The actions whose feedback topics are among `topics`."""
    return {
        topic.removesuffix(_ACTION_FEEDBACK): [name.removesuffix(_FEEDBACK_TYPE) for name in types]
        for topic, types in topics.items()
        if topic.endswith(_ACTION_FEEDBACK)
    }


def visible(names: Names, *, hidden_too: bool = False) -> Names:
    """`names` in order, without the hidden ones unless asked for."""
    return {name: types for name, types in sorted(names.items()) if hidden_too or not is_hidden(name)}
