"""What a field accepts while ROS_PYTHON_CHECK_FIELDS is 1, worded as rosidl_generator_py words it."""

from __future__ import annotations

import array
import math
import os
from collections import UserList, UserString
from collections.abc import Callable, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from course_kit.interfaces.field_types import FieldType, Primitive
    from course_kit.interfaces.message_fields import MessageField

_LARGEST = {"float": 3.402823466e38, "double": 1.7976931348623157e308}

Check = Callable[[object], None]


def checks_by_default() -> bool:
    """Whether a new message checks what is assigned to its fields.

    The course switches that on for everyone; a value the user has set wins. It is on for live types from the start:
    a program may import its interfaces before rclpy, which is when the course's settings are made.
    """
    return os.environ.get("ROS_PYTHON_CHECK_FIELDS", "1") == "1"


def field_check(field: MessageField) -> Check:
    """Make the function that accepts or refuses a value for a field.

    The function raises AssertionError, as the assertions in compiled message classes do.
    """
    if field.type.container:
        return _container_check(field)
    if field.nested is not None:
        return _instance_check(field.name, field.nested, f"a sub message of type '{field.nested.__name__}'")
    if field.type.primitive:
        return _primitive_check(field.name, field.type.primitive)
    if field.type.string_bound:
        return _bounded_string_check(field.name, field.type.string_bound)
    return _instance_check(field.name, str, "of type 'str'")


def _refuse(name: str, expected: str) -> NoReturn:
    raise AssertionError(f"The '{name}' field must be {expected}")


def _instance_check(name: str, cls: type, expected: str) -> Check:
    def check(value: object) -> None:
        if not isinstance(value, cls):
            _refuse(name, expected)

    return check


def _bounded_string_check(name: str, bound: int) -> Check:
    def check(value: object) -> None:
        if not isinstance(value, (str, UserString)) or len(value) > bound:
            _refuse(name, f"string value not longer than {bound}")

    return check


def _primitive_check(name: str, primitive: Primitive) -> Check:
    if primitive.python is bytes:
        return _octet_check(name)
    if primitive.integer_range:
        return _integer_check(name, primitive, *primitive.integer_range)
    if primitive.python is float:
        return _float_check(name, primitive.idl, _LARGEST[primitive.idl])
    return _instance_check(name, primitive.python, f"of type '{primitive.python.__name__}'")


def _octet_check(name: str) -> Check:
    def check(value: object) -> None:
        if not isinstance(value, (bytes, bytearray)) or len(value) != 1:
            _refuse(name, "of type 'bytes' or 'ByteString' with length 1")

    return check


def _integer_check(name: str, primitive: Primitive, smallest: int, largest: int) -> Check:
    article = "an unsigned integer" if primitive.idl.startswith("u") else "an integer"

    def check(value: object) -> None:
        if not isinstance(value, int):
            _refuse(name, "of type 'int'")
        if not smallest <= value <= largest:
            _refuse(name, f"{article} in [{smallest}, {largest}]")

    return check


def _float_check(name: str, idl: str, largest: float) -> Check:
    def check(value: object) -> None:
        if not isinstance(value, float):
            _refuse(name, "of type 'float'")
        if abs(value) > largest and not math.isinf(value):
            _refuse(name, f"a {idl} in [{-largest}, {largest}]")

    return check


def _container_check(field: MessageField) -> Check:
    name, kind = field.name, field.type
    value_type = field.nested or (kind.primitive.python if kind.primitive else str)
    expected = _container_words(kind, value_type)

    def check(value: object) -> None:
        if _is_accepted_as_is(name, kind, value):
            return
        if not isinstance(value, (Sequence, AbstractSet, UserList)) or isinstance(value, (str, UserString)):
            _refuse(name, expected)
        fit = (isinstance(item, value_type) and _fits_value(kind, item) for item in value)
        if not _fits_size(kind, len(value)) or not all(fit):
            _refuse(name, expected)

    return check


def _is_accepted_as_is(name: str, kind: FieldType, value: object) -> bool:
    """Whether the value is the very container of numbers the field keeps; refuses one of the wrong kind."""
    primitive = kind.primitive
    if primitive is None or not kind.is_numeric_container:
        return False
    if kind.container == "sequence":
        if not isinstance(value, array.array):
            return False
        if value.typecode != primitive.array_code:
            _refuse_container(name, f"array.array() must have the type code of '{primitive.array_code}'")
        if kind.size and len(value) > kind.size:
            _refuse_container(name, f"array.array() must have a size <= {kind.size}")
        return True
    import numpy as np

    if not isinstance(value, np.ndarray):
        return False
    if value.dtype != np.dtype(primitive.numpy):
        _refuse_container(name, f"numpy.ndarray() must have the dtype of 'numpy.{primitive.numpy}'")
    if value.size != kind.size:
        _refuse_container(name, f"numpy.ndarray() must have a size of {kind.size}")
    return True


def _refuse_container(name: str, expected: str) -> NoReturn:
    raise AssertionError(f"The '{name}' {expected}")


def _fits_size(kind: FieldType, length: int) -> bool:
    if kind.container == "array":
        return length == kind.size
    return not kind.size or length <= kind.size


def _fits_value(kind: FieldType, value: Any) -> bool:
    if kind.is_string:
        return not kind.string_bound or len(value) <= kind.string_bound
    if kind.primitive is None:
        return True
    if kind.primitive.integer_range:
        smallest, largest = kind.primitive.integer_range
        return bool(smallest <= value <= largest)
    largest_float = _LARGEST.get(kind.base)
    return largest_float is None or not abs(value) > largest_float or math.isinf(value)


def _container_words(kind: FieldType, value_type: type) -> str:
    words = ["a set or sequence"]
    if kind.container == "array":
        words.append(f"with length {kind.size}")
    elif kind.size:
        words.append(f"with length <= {kind.size}")
    if kind.string_bound:
        words.append(f"and each string value not longer than {kind.string_bound}")
    words.append(f"and each value of type '{value_type.__name__}'")
    if kind.primitive and kind.primitive.integer_range:
        smallest, largest = kind.primitive.integer_range
        unsigned = "unsigned " if kind.base.startswith("u") else ""
        words.append(f"and each {unsigned}integer in [{smallest}, {largest}]")
    elif kind.base in _LARGEST:
        words.append(f"and each {kind.base} in [{-_LARGEST[kind.base]:f}, {_LARGEST[kind.base]:f}]")
    return " ".join(words)
