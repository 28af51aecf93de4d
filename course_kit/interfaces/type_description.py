"""Type descriptions and type hashes (REP 2011): how two ends of a topic know that they mean the same type.

A hash is the SHA-256 of a JSON text that lists a type's fields and those of every type it refers to.
"""

from __future__ import annotations

import hashlib
import json
from functools import lru_cache
from typing import NamedTuple

from course_kit.interfaces.definition import EMPTY_MEMBER, FieldType
from course_kit.interfaces.known_types import installed_text
from course_kit.interfaces.message_fields import message_fields, record_of

# type_description_interfaces/msg/FieldType: containers are ranges of numbers above the values' own.
_NESTED, _STRING, _WSTRING, _BOUNDED_STRING, _BOUNDED_WSTRING = 1, 17, 18, 21, 22
_ARRAY, _BOUNDED_SEQUENCE, _UNBOUNDED_SEQUENCE = 48, 96, 144

_SERVICE_PARTS = {"request_message": "Request", "response_message": "Response", "event_message": "Event"}
_ACTION_PARTS = {"goal": "Goal", "result": "Result", "feedback": "Feedback"}
_ACTION_DERIVED_PARTS = {
    "send_goal_service": "SendGoalService",
    "get_result_service": "GetResultService",
    "feedback_message": "FeedbackMessage",
}


class DescribedField(NamedTuple):
    """A field as the description lists it."""

    name: str
    type_id: int
    capacity: int
    string_capacity: int
    nested_type_name: str
    default_value: str


class DescribedType(NamedTuple):
    """One type's own description; `refers_to` are the classes of its fields."""

    type_name: str
    fields: tuple[DescribedField, ...]
    refers_to: tuple[type, ...]


@lru_cache(maxsize=512)
def describe_type(cls: type) -> DescribedType:
    """Describe a message, service or action class, live or compiled."""
    parts = _parts(cls)
    if parts is None:
        return _describe_message(cls)
    fields = tuple(_describe_field(name, FieldType(full_name(part))) for name, part in parts.items())
    return DescribedType(full_name(cls), fields, tuple(parts.values()))


def referenced_classes(cls: type) -> list[type]:
    """The classes a type refers to, directly or not, sorted by full name, without itself."""
    found: dict[str, type] = {}
    to_do = [*describe_type(cls).refers_to]
    while to_do:
        other = to_do.pop()
        if full_name(other) not in found:
            found[full_name(other)] = other
            to_do += describe_type(other).refers_to
    return [found[name] for name in sorted(found)]


def type_hash(cls: type) -> bytes:
    """The 32 bytes of a type's hash; written "RIHS01_" and their hexadecimal digits."""
    text = json.dumps(
        {
            "type_description": _hashed_parts(describe_type(cls)),
            "referenced_type_descriptions": [_hashed_parts(describe_type(other)) for other in referenced_classes(cls)],
        },
        separators=(", ", ": "),
    )
    return hashlib.sha256(text.encode()).digest()


def full_name(cls: type) -> str:
    """The full name of a class, such as "my_interfaces/srv/PersonInfo"; its module's name tells it."""
    package, folder, *_ = cls.__module__.split(".")
    return f"{package}/{folder}/{cls.__name__}"


@lru_cache(maxsize=512)
def source_text(cls: type) -> tuple[str, str]:
    """The encoding and text of a type's definition; ("implicit", "") for a part of a service or an action."""
    live = record_of(cls)
    if live is not None:
        return live.source
    package, kind, name = full_name(cls).split("/")
    text = installed_text(package, kind, name)
    return ("implicit", "") if text is None else (kind, text)


def _parts(cls: type) -> dict[str, type] | None:
    if hasattr(cls, "Impl"):
        parts = {name: getattr(cls, part) for name, part in _ACTION_PARTS.items()}
        return parts | {name: getattr(cls.Impl, part) for name, part in _ACTION_DERIVED_PARTS.items()}
    if hasattr(cls, "Request"):
        return {name: getattr(cls, part) for name, part in _SERVICE_PARTS.items()}
    return None


def _describe_message(cls: type) -> DescribedType:
    fields = message_fields(cls)
    described = tuple(_describe_field(field.name, field.type, field.default) for field in fields)
    nested = tuple(field.nested for field in fields if field.nested is not None)
    return DescribedType(full_name(cls), described or (_describe_field(EMPTY_MEMBER, FieldType("uint8")),), nested)


def _describe_field(name: str, kind: FieldType, default: str = "") -> DescribedField:
    container = 0
    if kind.container == "array":
        container = _ARRAY
    elif kind.container == "sequence":
        container = _BOUNDED_SEQUENCE if kind.size else _UNBOUNDED_SEQUENCE
    nested = kind.base if kind.is_nested else ""
    return DescribedField(name, container + _value_id(kind), kind.size, kind.string_bound, nested, default)


def _value_id(kind: FieldType) -> int:
    if kind.primitive:
        return kind.primitive.description_id
    if kind.base == "string":
        return _BOUNDED_STRING if kind.string_bound else _STRING
    if kind.base == "wstring":
        return _BOUNDED_WSTRING if kind.string_bound else _WSTRING
    return _NESTED


def _hashed_parts(described: DescribedType) -> dict[str, object]:
    """What of a description enters the hash: all but default values."""
    return {
        "type_name": described.type_name,
        "fields": [
            {
                "name": field.name,
                "type": {
                    "type_id": field.type_id,
                    "capacity": field.capacity,
                    "string_capacity": field.string_capacity,
                    "nested_type_name": field.nested_type_name,
                },
            }
            for field in described.fields
        ],
    }
