"""What an exercise names of a program: services, actions and topics, each with its interface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.actions import ActionChannels
from course_kit.interfaces import get_type
from course_kit.ros.messages import type_name

if TYPE_CHECKING:
    from course_kit.grading.checks.grader_node import GraderNode, Offer
    from course_kit.grading.model.plain_data import Record


@dataclass(frozen=True)
class WantedEndpoint:
    """One of them.

    Attributes:
        kind: what the program has: "service", "action", "publisher" or "subscription".
        name: its full name.
        interface: its class.
    """

    kind: str
    name: str
    interface: Any

    @classmethod
    def from_record(cls, record: Record) -> WantedEndpoint:
        """As exercise.toml names it."""
        return cls(record["kind"], record["name"], get_type(record["type"]))

    @property
    def type(self) -> str:
        """The interface's name, `package/srv/Name`."""
        return type_name(self.interface)

    @property
    def is_server(self) -> bool:
        """Whether it is a service or an action, not the end of a topic."""
        return self.kind in ("service", "action")

    def is_ready(self, node: GraderNode) -> bool:
        """Whether the grader's own end, made on first use, is connected with it."""
        if self.kind == "service":
            return node.client(self.interface, self.name).is_ready()
        if self.kind == "action":
            return ActionChannels(node, self.name, self.interface).ready()
        if self.kind == "publisher":
            node.inbox(self.interface, self.name)
            return bool(node.publishers(self.name))
        return bool(node.publisher(self.interface, self.name).get_subscription_count())

    def offers(self, node: GraderNode) -> list[Offer]:
        """All servers of this kind on the graph."""
        return node.services() if self.kind == "service" else node.actions()
