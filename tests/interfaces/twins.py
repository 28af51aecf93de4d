"""Compiled types of the wheels, live types made from the same texts, and messages filled with random values."""

from __future__ import annotations

import array
import ctypes
import random
from functools import cache
from typing import Any

import numpy as np

from course_kit.interfaces import known_types, types
from course_kit.interfaces.definition import TypeName
from course_kit.interfaces.library import Library
from course_kit.interfaces.message_fields import MessageField, message_class, message_fields, record_of
from course_kit.interfaces.native.loader import capsule_pointer

# Texts say all there is to say about a type, but these exist as .idl only, or not as classes at all.
PACKAGES = sorted(known_types.installed_packages())
LETTERS = "abc é漢😀 xyz"


@cache
def twins_of(package: str) -> list[tuple[Any, Any]]:
    """Pairs of a compiled and a live class: all messages, services and actions of a package, and their parts."""
    library = Library(lambda name: known_types.installed_text(*name))
    pairs = []
    for full_name in types(package):
        name = TypeName(*full_name.split("/"))
        built = library.get(name)
        assert built is not None, full_name
        for part, live in built.classes.items():
            pairs.append((compiled_class(f"{package}/{name.kind}/{part}"), live))
    return pairs


def message_twins(package: str) -> list[tuple[Any, Any]]:
    return [pair for pair in twins_of(package) if hasattr(pair[0], "SLOT_TYPES")]


def compiled_class(full_name: str) -> Any:
    cls = message_class(full_name)
    assert record_of(cls) is None, f"{full_name} is not a compiled class here"
    return cls


def type_support(cls: Any) -> int:
    if type(cls)._TYPE_SUPPORT is None:
        type(cls).__import_type_support__()
    return capsule_pointer(type(cls)._TYPE_SUPPORT)


def read_words(address: int, count: int = 1) -> tuple[int, ...]:
    return tuple((ctypes.c_uint64 * count).from_address(address))


def described_by_c(cls: Any, getter: int) -> int:
    """Call one of the three last functions of a type support: 0 the hash, 1 the description, 2 the sources."""
    first = 40 if hasattr(cls, "Impl") else 64 if hasattr(cls, "Request") else 24
    support = type_support(cls)
    function = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(read_words(support + first + 8 * getter)[0])
    return function(support)


def hash_by_c(cls: Any) -> bytes:
    return ctypes.string_at(described_by_c(cls, 0), 33)


def _strings(address: int, count: int) -> list[str]:
    """Some rosidl_runtime_c__type_description__String in a row; a compiled one may count its terminator."""
    found = []
    for i in range(count):
        data, size, _ = read_words(address + 24 * i, 3)
        found.append(ctypes.string_at(data, size).rstrip(b"\0").decode(errors="replace") if size else "")
    return found


def _described_type(address: int) -> tuple[str, list[Any]]:
    first, count, _ = read_words(address + 24, 3)
    fields = []
    for field in range(first, first + 96 * count, 96):
        name, (nested, default) = _strings(field, 1), _strings(field + 48, 2)
        if not default.isascii() or "\\x" in default:
            default = "not ASCII"  # rosidl's generator writes out an escaped form, and cuts it off
        fields.append((name, ctypes.string_at(field + 24, 1), read_words(field + 32, 2), nested, default))
    return _strings(address, 1)[0], fields


def description_by_c(cls: Any) -> list[Any]:
    """A type's description, and those of the types it refers to, as its type support gives them."""
    address = described_by_c(cls, 1)
    first, count, _ = read_words(address + 48, 3)
    return [_described_type(address), *(_described_type(first + 48 * i) for i in range(count))]


def sources_by_c(cls: Any) -> list[list[str]]:
    """Name, encoding and text of a type and of those it refers to, as its type support gives them."""
    first, count, _ = read_words(described_by_c(cls, 2), 3)
    return [_strings(first + 72 * i, 3) for i in range(count)]


def seeded(seed: object) -> random.Random:
    """Random numbers that are the same in each run."""
    return random.Random(str(seed))  # noqa: S311 - nothing secret


def random_message(cls: Any, rng: random.Random, depth: int = 0) -> Any:
    message = cls()
    for field in message_fields(cls):
        setattr(message, field.name, random_value(field, rng, depth))
    return message


def random_value(field: MessageField, rng: random.Random, depth: int) -> Any:
    kind = field.type
    if not kind.container:
        return random_single(field, rng, depth)
    count = kind.size
    if kind.container == "sequence":
        count = rng.choice([0, 0, 1, 2, 3, 5] if depth < 3 else [0, 1])
        count = min(count, kind.size) if kind.size else count
    values = [random_single(field, rng, depth) for _ in range(count)]
    if kind.is_numeric_container and kind.primitive:
        if kind.container == "array":
            return np.array(values, dtype=kind.primitive.numpy)
        return array.array(kind.primitive.array_code, values)
    return values


def random_single(field: MessageField, rng: random.Random, depth: int) -> Any:
    kind = field.type
    if field.nested is not None:
        return random_message(field.nested, rng, depth + 1)
    if kind.primitive is None:
        length = rng.choice([0, 1, 2, 3, 4, 5, 7, 11])
        return "".join(rng.choice(LETTERS) for _ in range(min(length, kind.string_bound or length)))
    if kind.primitive.integer_range:
        return rng.randint(*kind.primitive.integer_range)
    if kind.base == "boolean":
        return rng.random() < 0.5
    if kind.base == "octet":
        return bytes([rng.randrange(256)])
    value = rng.uniform(-1e5, 1e5)
    return float(np.float32(value)) if kind.base == "float" else value


def as_message_of(cls: Any, message: Any) -> Any:
    """The same content as a message of another class with the same fields."""
    copy = cls()
    for field in message_fields(cls):
        value = getattr(message, field.name)
        if field.nested is not None:
            many = field.type.container
            value = (
                [as_message_of(field.nested, item) for item in value] if many else as_message_of(field.nested, value)
            )
        setattr(copy, field.name, value)
    return copy
