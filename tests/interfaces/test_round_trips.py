"""Any definition, any values: what is encoded decodes to the same, and the native check accepts it."""

from __future__ import annotations

import array
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message

from course_kit.interfaces.definition import TypeName
from course_kit.interfaces.library import Library
from course_kit.interfaces.message_fields import message_fields
from course_kit.interfaces.parser import PRIMITIVE_NAMES
from tests.interfaces.twins import random_message, seeded

if TYPE_CHECKING:
    from course_kit.interfaces.message_fields import MessageField

MESSAGES = ("builtin_interfaces/Time", "geometry_msgs/Vector3", "std_msgs/Header", "std_msgs/Empty", "test_msgs/Nested")
BASES = st.sampled_from([*PRIMITIVE_NAMES, "string<=7", "wstring<=3", *MESSAGES])
SIZES = st.sampled_from(["", "", "[]", "[3]", "[1]", "[<=4]"])
DEFINITIONS = st.lists(st.tuples(BASES, SIZES), max_size=8)


def live_class(kinds: list[tuple[str, str]]) -> Any:
    text = "".join(f"{base}{size} field_{i}\n" for i, (base, size) in enumerate(kinds))
    built = Library(lambda _: text).get(TypeName("any_messages", "msg", "Any"))
    assert built is not None
    return built.classes["Any"]


@settings(max_examples=60, deadline=None)
@given(DEFINITIONS, st.integers(0, 2**32))
def test_any_definition(kinds: list[tuple[str, str]], seed: int) -> None:
    cls, rng = live_class(kinds), seeded(seed)
    for _ in range(3):
        message = random_message(cls, rng)
        payload = serialize_message(message)
        again = deserialize_message(payload, cls)
        assert repr(again) == repr(message)
        assert again == message
        assert serialize_message(again) == payload


EVERYTHING = live_class([(base, size) for size in ("", "[]", "[2]", "[<=3]") for base in PRIMITIVE_NAMES])


def values_of(field: MessageField) -> st.SearchStrategy[Any]:
    kind = field.type
    primitive = kind.primitive
    if primitive is None:
        letters = st.characters(exclude_characters="\0", exclude_categories=["Cs"])  # see the test on NUL
        single: st.SearchStrategy[Any] = st.text(letters, max_size=9)
    elif primitive.integer_range:
        single = st.integers(*primitive.integer_range)
    elif primitive.python is bool:
        single = st.booleans()
    elif primitive.python is bytes:
        single = st.binary(min_size=1, max_size=1)
    else:
        # rosidl_generator_py refuses the very largest float32, and so does a live class.
        numbers = st.floats(width=32 if kind.base == "float" else 64, allow_nan=False)
        single = numbers.filter(lambda value: kind.base == "double" or math.isinf(value) or abs(value) < 3.4e38)
    if not kind.container:
        return single
    most = kind.size or 5
    values = st.lists(single, min_size=most if kind.container == "array" else 0, max_size=most)
    if primitive and kind.is_numeric_container:
        if kind.container == "array":
            return values.map(lambda items: np.array(items, primitive.numpy))
        return values.map(lambda items: array.array(primitive.array_code, items))
    return values


@settings(max_examples=60, deadline=None)
@given(st.fixed_dictionaries({field.name: values_of(field) for field in message_fields(EVERYTHING)}))
def test_any_values(values: dict[str, Any]) -> None:
    message = EVERYTHING(check_fields=True, **values)
    again = deserialize_message(serialize_message(message), EVERYTHING)
    assert again == message
    assert repr(again) == repr(message)


def test_a_string_ends_at_the_first_nul_as_in_compiled_types() -> None:
    from std_msgs.msg import String

    cls = live_class([("string", "")])
    assert deserialize_message(serialize_message(cls(field_0="ab\0cd")), cls).field_0 == "ab"
    assert deserialize_message(serialize_message(String(data="ab\0cd")), String).data == "ab"


WRONG = [
    ("int64", "", "one", "the 'field_0' field must be of type 'int', and holds 'one'"),
    ("int8", "", 200, "must be an integer in [-128, 127]"),
    ("string", "", 5, "must be of type 'str'"),
    ("byte", "", b"ab", "with length 1"),
    ("geometry_msgs/Vector3", "", 1.0, "a sub message of type 'Vector3'"),
    ("string", "[<=2]", ["a", "b", "c"], "with length <= 2"),
    ("byte", "[]", [b"ab"], "must hold bytes objects of length 1"),
    ("int32", "[]", None, "a set or sequence"),
]


@pytest.mark.parametrize(("base", "size", "value", "expected"), WRONG)
def test_a_wrong_value_that_slipped_in_is_named_when_it_is_sent(
    base: str, size: str, value: Any, expected: str
) -> None:
    message = live_class([(base, size)])()
    message._field_0 = value  # as a list that was changed after it had been checked
    with pytest.raises(TypeError, match="Any cannot be sent") as caught:
        serialize_message(message)
    assert expected in str(caught.value)


def test_a_wrong_value_deep_inside_is_named() -> None:
    cls = live_class([("geometry_msgs/Vector3", "[]")])
    message = cls(field_0=[Vector3(), Vector3()])
    message.field_0[1]._y = "north"
    with pytest.raises(TypeError, match="Vector3 cannot be sent: the 'y' field must be of type 'float'") as caught:
        serialize_message(message)
    assert "holds 'north'" in str(caught.value)


LARGE_AND_LISTS = """
uint8[] image
bool after
float64[] cloud
string last
bool[] flags
byte[] raw
string[] words
string[2] pair
int64 end
"""


@pytest.mark.parametrize("size", [0, 4096, 5003])
def test_large_fields_between_others(size: int) -> None:
    """Large ones are parts of their own on the way to the wire: what follows them keeps its alignment."""
    built = Library(lambda _: LARGE_AND_LISTS).get(TypeName("large_fields", "msg", "Large"))
    assert built is not None
    cls = built.classes["Large"]
    message = cls(
        image=bytes(range(256)) * (size // 256) + bytes(size % 256),
        after=True,
        cloud=[0.5] * size,
        last="end",
        flags=[True, False, True] * size,
        raw=[b"a", b"\xff"] * size,
        words=["", "abc", "é" * 70, "x" * size],
        pair=["one", ""],
        end=-1,
    )
    assert deserialize_message(serialize_message(message), cls) == message


@pytest.mark.parametrize(
    "wrong", [{"flags": [True, 3]}, {"raw": [b"a", b"bc"]}, {"words": ["a", 3]}, {"words": [b"a"]}]
)
def test_what_does_not_fit_into_a_list_is_told(wrong: dict[str, Any]) -> None:
    built = Library(lambda _: LARGE_AND_LISTS).get(TypeName("large_fields", "msg", "Large"))
    assert built is not None
    message = built.classes["Large"](check_fields=False, **wrong)
    if "flags" in wrong:  # as compiled classes have it: what is true is true
        assert deserialize_message(serialize_message(message), type(message)).flags == [True, True]
        return
    with pytest.raises(TypeError, match=f"Large cannot be sent: the '{next(iter(wrong))}' field must"):
        serialize_message(message)
