"""What an exercise names: services, actions and topics, each with its interface."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Generic, TypeVar

from course_kit.ros.messages import MessageType, ServiceType, type_name

if TYPE_CHECKING:
    from course_kit.grading.checks.grader_node import GraderNode, Offer
    from course_kit.ros.service import ServiceClient

Interface = TypeVar("Interface")


@dataclass(frozen=True)
class Named(Generic[Interface]):
    """One of them.

    Attributes:
        kind: "service", "action" or "topic"; also the last part of the diagnosis for a wrong name.
        name: its full name.
        interface: its class.
    """

    kind: ClassVar[str]
    name: str
    interface: Interface

    @property
    def type(self) -> str:
        """The interface's name, `package/srv/Name`."""
        return type_name(self.interface)


class Server(Named[Interface], ABC):
    """A service or an action."""

    @abstractmethod
    def ready(self, node: GraderNode) -> bool:
        """Whether the grader's own clients are connected with it."""

    @abstractmethod
    def offers(self, node: GraderNode) -> list[Offer]:
        """Everything of this kind on the graph."""


@dataclass(frozen=True)
class Service(Server[ServiceType]):
    """A service; for an action see `WantedAction`."""

    kind: ClassVar[str] = "service"

    def client(self, node: GraderNode, number: int = 0) -> ServiceClient:
        """The grader's client `number`."""
        return node.client(self.interface, self.name, number)

    def ready(self, node: GraderNode) -> bool:
        """See `Server`."""
        return self.client(node).is_ready()

    def offers(self, node: GraderNode) -> list[Offer]:
        """See `Server`."""
        return node.services()


@dataclass(frozen=True)
class Topic(Named[MessageType]):
    """A topic."""

    kind: ClassVar[str] = "topic"
