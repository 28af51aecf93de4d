"""What this kit remembers of a class it has made: on its metaclass, where `dir()` of the class does not show it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import ctypes

    from course_kit.interfaces.message_fields import MessageField

_ATTRIBUTE = "_live"


class LiveType(NamedTuple):
    """A type in the table of one copy of the native helper."""

    helper: ctypes.PyDLL
    address: int


@dataclass
class LiveRecord:
    """One live class."""

    source: tuple[str, str]
    fields: tuple[MessageField, ...] = ()
    cls: type | None = None
    native: LiveType | None = None

    def attach(self, cls: type) -> None:
        """Remember this for a class just made."""
        self.cls = cls
        setattr(type(cls), _ATTRIBUTE, self)


def record_of(cls: type) -> LiveRecord | None:
    """The record of a live class; None for a compiled one."""
    return getattr(type(cls), _ATTRIBUTE, None)


def class_of(metaclass: type) -> type:
    """The live class a metaclass was made for; rclpy asks metaclasses for type support."""
    cls: type = getattr(metaclass, _ATTRIBUTE).cls
    return cls


def source_of(kind: str, text: str | None) -> tuple[str, str]:
    """A `LiveRecord.source`."""
    return ("implicit", "") if text is None else (kind, text)
