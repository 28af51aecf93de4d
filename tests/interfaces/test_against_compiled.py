"""Every type the wheels have compiled, made live from its text, must be the same in all one can observe."""

from __future__ import annotations

import inspect
from typing import Any

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from course_kit.interfaces.type_description import type_hash
from tests.interfaces.twins import (
    PACKAGES,
    as_message_of,
    description_by_c,
    hash_by_c,
    message_twins,
    random_message,
    seeded,
    sources_by_c,
    twins_of,
)

MESSAGES_EACH = 6

pytestmark = pytest.mark.parametrize("package", PACKAGES)


def test_the_wheels_have_types_to_compare_with(package: str) -> None:
    assert twins_of(package)


def test_hashes_are_equal(package: str) -> None:
    for compiled, live in twins_of(package):
        assert hash_by_c(live) == hash_by_c(compiled), compiled
        # The compiled class described by our own code, too: its nested types appear in live descriptions.
        assert b"\1" + type_hash(compiled) == hash_by_c(compiled), compiled


def test_descriptions_and_sources_are_equal(package: str) -> None:
    for compiled, live in twins_of(package):
        assert description_by_c(live) == description_by_c(compiled), compiled
        for ours, theirs in zip(sources_by_c(live), sources_by_c(compiled), strict=True):
            assert ours[:2] == theirs[:2]
            if ours[2].isascii() and not set("'\\") & set(ours[2]):  # rosidl's generator cuts others off
                assert ours[2].rstrip() == theirs[2].rstrip()


def test_bytes_are_equal(package: str) -> None:
    rng = seeded(package)
    for compiled, live in message_twins(package):
        for message in [compiled(), *(random_message(compiled, rng) for _ in range(MESSAGES_EACH))]:
            theirs, ours = serialize_message(message), serialize_message(as_message_of(live, message))
            # rmw_serialize estimates the length, never too short, and compiled code leaves padding uninitialised.
            assert len(ours) <= len(theirs)
            assert all(b in (a, 0) for a, b in zip(theirs, ours, strict=False)), (compiled, theirs, ours)
            assert repr(deserialize_message(ours, compiled)) == repr(message)
            assert repr(deserialize_message(theirs, live)) == repr(message)


def test_decoded_values_have_the_same_python_types(package: str) -> None:
    rng = seeded(package)
    for compiled, live in message_twins(package):
        payload = serialize_message(random_message(compiled, rng))
        theirs, ours = deserialize_message(payload, compiled), deserialize_message(payload, live)
        for name in compiled.get_fields_and_field_types():
            a, b = getattr(theirs, name), getattr(ours, name)
            assert type(a).__name__ == type(b).__name__, (compiled, name)
            assert getattr(a, "dtype", None) == getattr(b, "dtype", None), (compiled, name)
            assert getattr(a, "typecode", None) == getattr(b, "typecode", None), (compiled, name)


def test_classes_look_the_same(package: str) -> None:
    for compiled, live in twins_of(package):
        assert facts(live) == facts(compiled)


def facts(cls: Any) -> dict[str, Any]:
    shown = {
        "name": cls.__name__,
        "module": cls.__module__,
        "metaclass": type(cls).__name__,
        "documentation": [inspect.getdoc(cls), inspect.getdoc(type(cls))],
        "attributes": sorted(name for name in dir(cls) if not name.startswith("__")),
    }
    if hasattr(cls, "SLOT_TYPES"):
        shown |= {
            "fields": cls.get_fields_and_field_types(),
            "slots": cls.__slots__,
            "slot types": [(type(slot), repr(slot_facts(slot))) for slot in cls.SLOT_TYPES],
            "default": repr(cls()),
            "constants": {n: repr(getattr(cls, n)) for n in dir(cls) if n.isupper() and n != "SLOT_TYPES"},
            "on an instance": {n: repr(getattr(cls(), n)) for n in dir(cls) if n.isupper() and n != "SLOT_TYPES"},
            "hashable": cls.__hash__ is not None,
        }
    return shown


def slot_facts(slot: Any) -> Any:
    if hasattr(slot, "value_type"):
        sizes = [getattr(slot, name, None) for name in ("size", "maximum_size")]
        return [type(slot).__name__, slot_facts(slot.value_type), sizes]
    return [type(slot).__name__, {name: getattr(slot, name) for name in getattr(slot, "__slots__", ())}]


def test_equality_and_unknown_arguments(package: str) -> None:
    rng = seeded(package)
    for _, live in message_twins(package):
        message = random_message(live, rng)
        assert message == message  # noqa: PLR0124 - equality is what is tested
        assert message != object()
        with pytest.raises(AssertionError, match="Invalid arguments passed to constructor: no_such_field"):
            live(no_such_field=1)
