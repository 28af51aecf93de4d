"""Messages shown to people: plain copies of them, small and bounded, and these in a line of words.

A copy is safe to keep or to send to another process: a learner may change a message after sending it, and an image has
megabytes. What `ros2` prints of messages is laid out as the real command does it, in `ros2cli.text`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypeAlias

Plain: TypeAlias = "int | float | bool | str | list[Plain] | dict[str, Plain] | None"

ELEMENTS = 8  # of a sequence
CHARACTERS = 120  # of a string
FIELDS = 12  # of a message
DEPTH = 4  # of messages inside messages
_LONGEST = 160  # characters of a line
_PLAIN = frozenset({int, float, bool, type(None)})
_PARAMETER_VALUE = {"type", "bool_value", "string_array_value"}


def copy_message(  # noqa: PLR0911 - a table of types
    value: Any, elements: int = ELEMENTS, *, last: bool = False, depth: int = DEPTH
) -> Plain:
    """Copy a message into numbers, strings, lists and dicts; of long sequences the first elements, or the last."""
    kind = type(value)
    if kind in _PLAIN:
        return value  # type: ignore[no-any-return] # by the set
    if kind is str:
        return _shorten(value)

    def copy(part: Any, depth: int) -> Plain:
        return part if type(part) in _PLAIN else copy_message(part, elements, last=last, depth=depth)

    names = _field_names(kind)  # type: ignore[arg-type] # a class can be a key
    if names is not None:
        if depth == 0:
            return {"...": "..."}
        more: dict[str, Plain] = {"...": f"+{len(names) - FIELDS} more"} if len(names) > FIELDS else {}
        return {name: copy(getattr(value, name), depth - 1) for name in names[:FIELDS]} | more
    if isinstance(value, dict):  # what the recorder notes of a callback or a goal
        return {name: copy(part, depth - 1) for name, part in value.items()}
    if isinstance(value, str) or not (hasattr(value, "__len__") and hasattr(value, "__getitem__")):
        return _shorten(str(_as_python(value)))
    copied = [copy(_as_python(each), depth) for each in (value[-elements:] if last else value[:elements])]
    if len(value) <= elements:
        return copied
    return ["...", *copied] if last else [*copied, f"+{len(value) - elements} more"]


def describe_message(value: Plain, digits: int | None = None) -> str:
    """The fields of a copied message in one line: "a=1, b=2", floats with so many digits; "(empty)" without fields."""
    text = _fields(value, digits) if isinstance(value, dict) else _value(value, digits)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


@lru_cache(maxsize=256)
def _field_names(kind: type) -> tuple[str, ...] | None:
    """The fields of a message class; None for any other class."""
    names = getattr(kind, "_fields_and_field_types", None)
    return None if names is None else tuple(names)


def _as_python(element: object) -> object:
    """A numpy number as Python's own; ROS arrays of fixed size are numpy arrays."""
    item = getattr(element, "item", None)
    return item() if callable(item) else element


def _shorten(text: str) -> str:
    return text if len(text) <= CHARACTERS else text[: CHARACTERS - 3] + "..."


def _fields(fields: dict[str, Plain], digits: int | None) -> str:
    if not fields:
        return "(empty)"
    return ", ".join(
        str(value) if name == "..." else f"{name}={_value(value, digits)}" for name, value in fields.items()
    )


def _value(value: Plain, digits: int | None) -> str:
    if isinstance(value, dict):
        return _parameter(value) if value.keys() >= _PARAMETER_VALUE else f"{{{_fields(value, digits)}}}"
    if isinstance(value, list):
        return f"[{', '.join(describe_element(item, digits) for item in value)}]"
    return f"{value:.{digits}f}" if isinstance(value, float) and digits is not None else repr(value)


def _parameter(value: dict[str, Plain]) -> str:
    """An rcl_interfaces/msg/ParameterValue: the one of its nine fields that its type says is in use."""
    fields = [name for name in value if name != "type"]
    number = value["type"]
    known = isinstance(number, int) and 0 < number <= len(fields)
    return _value(value[fields[int(str(number)) - 1]], None) if known else "not set"


def describe_element(value: Plain, digits: int | None = None) -> str:
    """A value in a list, or what stands there for those that were left out."""
    left_out = isinstance(value, str) and (value == "..." or (value.startswith("+") and value.endswith(" more")))
    return str(value) if left_out else _value(value, digits)
