"""Packs type descriptions the way rosidl_runtime_c lays them out in memory.

rosidl_runtime_c__type_description__*: a String is (data, size, capacity), a sequence the same, and a Field is its
name, its FieldType (id, capacity, string capacity, name of the nested type) and its default value.
"""

from __future__ import annotations

import struct
from functools import lru_cache
from typing import TYPE_CHECKING

from course_kit.interfaces.native.memory import keep, keep_text
from course_kit.interfaces.type_description import describe, referenced_classes, source_text, type_hash

if TYPE_CHECKING:
    from course_kit.interfaces.type_description import DescribedField

_HASH_VERSION = 1


def description_of(cls: type) -> int:
    """Address of the helper's `struct description` of a message, service or action class."""
    classes = [cls, *referenced_classes(cls)]
    type_hash_address = keep(bytes([_HASH_VERSION]) + type_hash(cls))
    description = keep(_individual(cls) + _sequence([_individual(other) for other in classes[1:]]))
    sources = keep(_sequence([_source(other) for other in classes]))
    return keep(struct.pack("3Q", type_hash_address, description, sources))


@lru_cache(maxsize=512)
def _individual(cls: type) -> bytes:
    described = describe(cls)
    return _string(described.type_name) + _sequence([_field(field) for field in described.fields])


def _field(field: DescribedField) -> bytes:
    kind = struct.pack("B7xQQ", field.type_id, field.capacity, field.string_capacity)
    return _string(field.name) + kind + _string(field.nested_type_name) + _string(field.default_value)


@lru_cache(maxsize=512)
def _source(cls: type) -> bytes:
    encoding, text = source_text(cls)
    return _string(describe(cls).type_name) + _string(encoding) + _string(text)


def _string(text: str) -> bytes:
    data = text.encode()
    return struct.pack("3Q", keep_text(text), len(data), len(data) + 1)


def _sequence(items: list[bytes]) -> bytes:
    return struct.pack("3Q", keep(b"".join(items)) if items else 0, len(items), len(items))
