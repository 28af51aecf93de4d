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
    from course_kit.interfaces.definition import FieldType, Primitive
    from course_kit.interfaces.message_fields import MessageField

_LARGEST_BYTE = 255
_LARGEST = {"float": 3.402823466e38, "double": 1.7976931348623157e308}

Check = Callable[[object], None]


def checks_by_default() -> bool:
    """Whether a new message checks what is assigned to its fields."""
    return os.environ.get("ROS_PYTHON_CHECK_FIELDS", "1") == "1"


def largest_float(primitive: Primitive) -> float:
    """The largest finite number that a field of a floating point type takes."""
    return _LARGEST[primitive.idl]


def field_check(field: MessageField) -> Check:
    """Make the function that accepts or refuses a value for a field."""
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
    fit = _elements_check(kind, value_type)

    def check(value: object) -> None:
        if _is_accepted_as_is(name, kind, value):
            return
        if not isinstance(value, (Sequence, AbstractSet, UserList)) or isinstance(value, (str, UserString)):
            _refuse(name, expected)
        if not _fits_size(kind, len(value)) or (len(value) and not fit(value)):
            if kind.base == "octet" and isinstance(value, (bytes, bytearray)) and value:
                _refuse(name, f"{expected}: write {_one_by_one(value)}, or make it uint8[]")
            _refuse(name, expected)

    return check


def _one_by_one(value: bytes | bytearray) -> str:
    """How some bytes are written as the elements of a byte[]; the first two tell it."""
    shown = ", ".join(repr(bytes([one])) for one in value[:2])
    return f"[{shown}{', ...' if len(value) > 2 else ''}]"  # noqa: PLR2004


def _elements_check(kind: FieldType, value_type: type) -> Callable[[Any], bool]:
    """Make the function that tells whether all elements, one at least, are of the type and in its range."""

    def of_type(values: Any) -> bool:
        return all(issubclass(one, value_type) for one in set(map(type, values)))

    primitive = kind.primitive
    if primitive and primitive.integer_range:
        smallest, largest = primitive.integer_range

        def integers(values: Any) -> bool:
            if isinstance(values, (bytes, bytearray)):
                return largest >= _LARGEST_BYTE or max(values) <= largest
            return of_type(values) and bool(smallest <= min(values) and max(values) <= largest)

        return integers
    if kind.base == "float":
        most = _LARGEST["float"]

        def floats(values: Any) -> bool:
            if not of_type(values):
                return False
            if (
                -most <= min(values) and max(values) <= most
            ):  # never true for a NaN at the beginning, which hides others
                return True
            return not any(abs(one) > most and not math.isinf(one) for one in values)

        return floats
    if kind.string_bound:
        return lambda values: of_type(values) and max(map(len, values)) <= kind.string_bound
    return of_type


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
