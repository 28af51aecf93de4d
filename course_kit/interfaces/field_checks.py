"""What a field accepts while ROS_PYTHON_CHECK_FIELDS is 1, worded as rosidl_generator_py words it."""

from __future__ import annotations

import array
import math
import os
from collections import UserList, UserString
from collections.abc import Callable, Collection, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from course_kit.interfaces.definition import FieldType
    from course_kit.interfaces.message_fields import MessageField

_LARGEST = {"float": 3.402823466e38, "double": 1.7976931348623157e308}

Check = Callable[[object], None]
Rule = tuple[str, Callable[[Any], bool]]  # what is expected, in words, and whether a value is that


def checks_by_default() -> bool:
    """Whether a new message checks what is assigned to its fields."""
    return os.environ.get("ROS_PYTHON_CHECK_FIELDS", "1") == "1"


def field_check(field: MessageField) -> Check:
    """Make the function that accepts or refuses a value for a field."""
    if field.type.container:
        return _container_check(field)
    rules = _rules(field)

    def check(value: object) -> None:
        for expected, fits in rules:
            if not fits(value):
                _refuse(field.name, expected)

    return check


def _refuse(name: str, expected: str) -> NoReturn:
    raise AssertionError(f"The '{name}' field must be {expected}")


def _rules(field: MessageField) -> list[Rule]:
    """What one value has to be, one thing after another."""
    kind, primitive = field.type, field.type.primitive
    if field.nested is not None:
        return [_is_a(field.nested, f"a sub message of type '{field.nested.__name__}'")]
    if primitive is None:
        bound = kind.string_bound
        if not bound:
            return [_is_a(str, "of type 'str'")]
        fits = lambda value: isinstance(value, (str, UserString)) and len(value) <= bound  # noqa: E731
        return [(f"string value not longer than {bound}", fits)]
    if primitive.python is bytes:
        words = "of type 'bytes' or 'ByteString' with length 1"
        return [_is_a((bytes, bytearray), words), (words, lambda value: kind.container != "" or len(value) == 1)]
    rules = [_is_a(primitive.python, f"of type '{primitive.python.__name__}'")]
    if primitive.integer_range:
        smallest, largest = primitive.integer_range
        words = "an unsigned integer" if primitive.idl.startswith("u") else "an integer"
        rules.append((f"{words} in [{smallest}, {largest}]", lambda value: smallest <= value <= largest))
    elif primitive.python is float:
        most = _LARGEST[primitive.idl]
        words = f"a {primitive.idl} in [{-most}, {most}]"
        rules.append((words, lambda value: -most <= value <= most or not math.isfinite(value)))
    return rules


def _is_a(kind: type | tuple[type, ...], words: str) -> Rule:
    return words, lambda value: isinstance(value, kind)


def _container_check(field: MessageField) -> Check:
    name, kind = field.name, field.type
    value_type = field.nested or (kind.primitive.python if kind.primitive else str)
    expected = _container_words(kind, value_type)
    rules = _rules(field)

    def check(value: object) -> None:
        if _is_accepted_as_is(name, kind, value):
            return
        if not isinstance(value, (Sequence, AbstractSet, UserList)) or isinstance(value, (str, UserString)):
            _refuse(name, expected)
        fit = (isinstance(value, (bytes, bytearray)) and kind.base == "uint8") or _all_fit(value, kind, rules)
        if not (fit and _fits_size(kind, len(value))):
            if kind.base == "octet" and isinstance(value, (bytes, bytearray)) and value:
                _refuse(name, f"{expected}: write {_one_by_one(value)}, or make it uint8[]")
            _refuse(name, expected)

    return check


def _all_fit(values: Collection[Any], kind: FieldType, rules: list[Rule]) -> bool:
    """Whether all elements are what they have to be; of whole numbers the least and the greatest tell it."""
    (_, is_one), *limits = rules
    if not all(map(is_one, values)):
        return False
    ends = (min(values), max(values)) if values and kind.primitive and kind.primitive.integer_range else values
    return all(fits(end) for _, fits in limits for end in ends)


def _one_by_one(value: bytes | bytearray) -> str:
    """How some bytes are written as the elements of a byte[]; the first two tell it."""
    text = ", ".join(repr(bytes([number])) for number in value[:2])
    return f"[{text}{', ...' if len(value) > 2 else ''}]"  # noqa: PLR2004


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
