"""Messages shown to people: plain copies of them, small and bounded, and these in a line of words.

A copy is safe to keep or to send to another process: a learner may change a message after sending it, and an image has
megabytes. What `ros2` prints of messages is laid out as the real command does it, in `ros2cli.text`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TypeAlias

Plain: TypeAlias = "int | float | bool | str | list[Plain] | dict[str, Plain] | None"

ELEMENTS = 8  # of a sequence
CHARACTERS = 120  # of a string
FIELDS = 12  # of a message
DEPTH = 4  # of messages inside messages
_LONGEST = 160  # characters of a line
_PLAIN = frozenset({int, float, bool, type(None)})
_PARAMETER_VALUE = {"type", "bool_value", "string_array_value"}


def copy_message(value: object, elements: int = ELEMENTS, *, last: bool = False) -> Plain:
    """Copy a message into numbers, strings, lists and dicts."""
    return _Copy(elements, last=last).copy_value(value, DEPTH)


def describe_message(value: Plain, digits: int | None = None) -> str:
    """The fields of a copied message in one line: "a=1, b=2", floats with so many digits; "(empty)" without fields."""
    text = _fields(value, digits) if isinstance(value, dict) else _value(value, digits)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def field_rows(value: Plain, path: str = "") -> list[list[str]]:
    """Path and value of each field of a copied message, messages inside it taken apart."""
    if not isinstance(value, dict):
        return [[path, _element(value, None)]]
    return [row for name, part in value.items() for row in field_rows(part, f"{path}.{name}" if path else name)]


class _Copy:
    """One copy that is being made."""

    def __init__(self, elements: int, *, last: bool) -> None:
        self._elements, self._last = elements, last

    def copy_value(self, value: object, depth: int) -> Plain:
        kind = type(value)
        if kind in _PLAIN:
            return value  # type: ignore[return-value] # by the set
        if kind is str:
            return _shorten(str(value))
        names = _field_names(kind)  # type: ignore[arg-type] # a class can be a key
        if names is not None:
            return self._message(value, names, depth)
        if isinstance(value, dict):
            return {str(name): self.copy_value(part, depth - 1) for name, part in list(value.items())[:FIELDS]}
        if not isinstance(value, str) and hasattr(value, "__len__") and hasattr(value, "__getitem__"):
            return self._sequence(value, len(value), depth)
        return _shorten(str(_as_python(value)))

    def _message(self, message: object, names: tuple[str, ...], depth: int) -> Plain:
        if depth == 0:
            return {"...": "..."}
        copied: dict[str, Plain] = {}
        for name in names[:FIELDS]:
            value = getattr(message, name)
            copied[name] = value if type(value) in _PLAIN else self.copy_value(value, depth - 1)
        if len(names) > FIELDS:
            copied["..."] = f"+{len(names) - FIELDS} more"
        return copied

    def _sequence(self, values: object, length: int, depth: int) -> Plain:
        part = values[-self._elements :] if self._last else values[: self._elements]  # type: ignore[index] # it has it
        copied = [self.copy_value(_as_python(element), depth) for element in part]
        if length <= self._elements:
            return copied
        return ["...", *copied] if self._last else [*copied, f"+{length - self._elements} more"]


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
        return f"[{', '.join(_element(item, digits) for item in value)}]"
    return f"{value:.{digits}f}" if isinstance(value, float) and digits is not None else repr(value)


def _parameter(value: dict[str, Plain]) -> str:
    """An rcl_interfaces/msg/ParameterValue: the one of its nine fields that its type says is in use."""
    fields = [name for name in value if name != "type"]
    number = value["type"]
    known = isinstance(number, int) and 0 < number <= len(fields)
    return _value(value[fields[int(str(number)) - 1]], None) if known else "not set"


def _element(value: Plain, digits: int | None) -> str:
    """A value in a list, or what stands there for those that were left out."""
    left_out = isinstance(value, str) and (value == "..." or (value.startswith("+") and value.endswith(" more")))
    return str(value) if left_out else _value(value, digits)
