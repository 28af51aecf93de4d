"""What this kit remembers of a class it has made: on its metaclass, where `dir()` of the class does not show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.interfaces.message_fields import MessageField

_ATTRIBUTE = "_live"


@dataclass
class LiveRecord:
    """One live class.

    Attributes:
        source: encoding and text of its definition; ("implicit", "") for a part of a service or an action.
        fields: those of a message, none for a service or an action.
        cls: the class itself.
        native: the record the native helper has of a message, once there is one.
    """

    source: tuple[str, str]
    fields: tuple[MessageField, ...] = ()
    cls: Any = None
    native: Any = None

    def attach(self, cls: Any) -> None:
        """Remember this for a class just made."""
        self.cls = cls
        setattr(type(cls), _ATTRIBUTE, self)


def record_of(cls: Any) -> LiveRecord | None:
    """The record of a live class; None for a compiled one."""
    return getattr(type(cls), _ATTRIBUTE, None)


def class_of(metaclass: Any) -> Any:
    """The live class a metaclass was made for; rclpy asks metaclasses for type support."""
    return getattr(metaclass, _ATTRIBUTE).cls


def source_of(kind: str, text: str | None) -> tuple[str, str]:
    """A `LiveRecord.source`."""
    return ("implicit", "") if text is None else (kind, text)
