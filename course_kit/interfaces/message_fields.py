"""The fields of a message class, live or compiled, with the classes of nested messages."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Protocol

from course_kit.interfaces.definition import FieldType, from_slot_type, module_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rosidl_parser.definition import AbstractType

_ATTRIBUTE = "_live"


@dataclass
class LiveRecord:
    """One live class."""

    cls: type
    source: tuple[str, str]
    fields: tuple[MessageField, ...]
    native: int = 0  # where the native helper keeps it


def record_of(cls: type) -> LiveRecord | None:
    """The record of a live class; None for a compiled one."""
    return getattr(type(cls), _ATTRIBUTE, None)


def keep_record(cls: type, kind: str, text: str | None, fields: tuple[MessageField, ...] = ()) -> None:
    """Keep a record of a class just made where rclpy, which asks metaclasses for type support, finds it."""
    setattr(type(cls), _ATTRIBUTE, LiveRecord(cls, ("implicit", "") if text is None else (kind, text), fields))


class Message(Protocol):
    """A message, as far as all have the same: what rosidl_generator_py puts into their classes, and this kit does."""

    SLOT_TYPES: ClassVar[Sequence[AbstractType]]

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """The names of the fields, each with its type as ROS writes it."""
        ...


MessageClass = type[Message]  # where `type` is the name of a field


class MessageField(NamedTuple):
    """One field of a class."""

    name: str
    type: FieldType
    nested: MessageClass | None
    default: str = ""


def message_fields(cls: type[Message]) -> tuple[MessageField, ...]:
    """The fields of a message class, in order."""
    live = record_of(cls)
    if live is not None:
        return live.fields
    types = [from_slot_type(slot) for slot in cls.SLOT_TYPES]
    return tuple(
        MessageField(name, kind, message_class(kind.base) if kind.is_nested else None, _compiled_default(cls, name))
        for name, kind in zip(cls.get_fields_and_field_types(), types, strict=True)
    )


def message_class(full_name: str) -> type[Message]:
    """Import a message class by its full name, such as "geometry_msgs/msg/Point"."""
    package, folder, name = full_name.split("/")
    module = importlib.import_module(f"{package}.{folder}")
    if not hasattr(module, name) and "_" in name:
        module = importlib.import_module(f"{package}.{folder}.{module_name(name.partition('_')[0])}")
    cls: type[Message] = getattr(module, name)
    return cls


def default_text(value: object) -> str:
    """A default value as type descriptions spell it."""
    if value is None:
        return ""
    return str(tuple(value)) if isinstance(value, list) else str(value)


def _compiled_default(cls: type[Message], name: str) -> str:
    value: object = getattr(cls, f"{name.upper()}__DEFAULT", None)
    if isinstance(value, bytes):
        return str(value[0])
    if hasattr(value, "tolist"):  # numpy.ndarray, array.array
        value = value.tolist()
    if isinstance(value, list):
        value = [item[0] if isinstance(item, bytes) else item for item in value]
    return default_text(value)
