"""What an exercise names: services, actions and topics, each with its interface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Generic, TypeVar

from course_kit.ros.messages import type_name

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

    @property
    def named(self) -> str:
        """It, as the learner reads it."""
        return f"{self.kind} {self.name} of type {self.type}"
