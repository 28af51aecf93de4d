"""Values in words, as short as they can be read."""

from __future__ import annotations

from typing import Any

_LONGEST = 160  # characters of an arrow's text
_PARAMETER_VALUE = {"type", "bool_value", "string_array_value"}


def in_words(value: Any) -> str:
    """The fields of a message: "a=1, b=2"; "(empty)" for one without fields."""
    text = _fields(value) if isinstance(value, dict) else _value(value)
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


def _fields(fields: dict[str, Any]) -> str:
    if not fields:
        return "(empty)"
    return ", ".join(str(value) if name == "..." else f"{name}={_value(value)}" for name, value in fields.items())


def _value(value: Any) -> str:
    if isinstance(value, dict):
        if value.keys() >= _PARAMETER_VALUE:
            return _parameter(value)
        return "{" + _fields(value) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_element(one) for one in value) + "]"
    return repr(value)


def _parameter(value: dict[str, Any]) -> str:
    """An rcl_interfaces/msg/ParameterValue: the one of its nine fields that its type says is in use."""
    fields = [name for name in value if name != "type"]
    number = value["type"]
    return _value(value[fields[number - 1]]) if 0 < number <= len(fields) else "not set"


def _element(value: Any) -> str:
    more = isinstance(value, str) and value.startswith("+") and value.endswith(" more")
    return str(value) if more else _value(value)
