"""How one parameter is drawn, and how what a person typed becomes its value."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.ros.parameters import Descriptor, Range

_STEPS = 100  # of a slider without steps of its own, about
_READ_ONLY = "read-only: it keeps the value it got at the start"
_KINDS = {"bool": "flag", "integer": "number", "double": "number", "string": "text"}
_EXAMPLES = {
    "integer": "a whole number such as 3",
    "double": "a number such as 1.5",
    "byte_array": "a list such as [0, 255]",
    "bool_array": "a list such as [true, false]",
    "integer_array": "a list such as [1, 2]",
    "double_array": "a list such as [1.0, 2.5]",
    "string_array": "a list such as [left, right]",
}
_CONVERT: dict[str, Callable[[Any], Any]] = {
    "byte_array": lambda one: bytes([one]),
    "double_array": float,
    "string_array": str,
}


class EntryError(ValueError):
    """What was typed is no value of the parameter's type; the message says what is."""


def entry(descriptor: Descriptor) -> dict[str, object]:
    """What the page has to know to draw a parameter."""
    kind = _KINDS.get(descriptor.type, "text")
    limits = descriptor.range
    drawn: dict[str, object] = {
        "name": descriptor.name,
        "type": descriptor.type.replace("_", " "),
        "kind": kind,
        "description": " ".join(text for text in (descriptor.description, descriptor.constraints) if text),
        "limits": str(limits) if limits else "",
        "note": _READ_ONLY if descriptor.read_only else "",
    }
    if limits and kind == "number" and limits.lowest < limits.highest:
        drawn |= {"kind": "slider", "lowest": limits.lowest, "highest": limits.highest}
        drawn["step"] = slider_step(limits, whole=descriptor.type == "integer")
    return drawn


def slider_step(limits: Range, *, whole: bool) -> float:
    """The step of a slider: the node's own, else a round one that leads to the upper limit."""
    width = limits.highest - limits.lowest
    if limits.step:
        return limits.step
    exact = width / _STEPS
    power = 10.0 ** math.floor(math.log10(exact))
    step = next(factor * power for factor in (5.0, 2.0, 1.0) if factor * power <= exact * (1 + 1e-9))
    if whole:
        return max(1, round(step))
    count = width / step
    return float(f"{step:.6g}") if math.isclose(count, round(count), rel_tol=1e-6) else exact


def shown(value: Any) -> Any:
    """A value as the page holds it: text, so that no digit is lost; a bool as it is."""
    if isinstance(value, bool):
        return value
    if value is None:
        return ""
    if isinstance(value, list):
        return "[" + ", ".join(_element(one) for one in value) + "]"
    return value if isinstance(value, str) else repr(value)


def typed(kind: str, text: Any) -> Any:
    """The value of what the page sent."""
    if kind in {"bool", "string"}:
        return text
    try:
        if kind == "integer":
            return int(text)
        if kind == "double":
            return float(text)
        return _from_yaml(kind, text)
    except (ValueError, TypeError, OverflowError):
        raise EntryError(f"{text!r} is not {_EXAMPLES.get(kind, 'a value')}.") from None


def _from_yaml(kind: str, text: str) -> Any:
    import yaml

    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise ValueError(text) from error
    if kind not in _EXAMPLES:  # a parameter whose type may change
        return value
    if not isinstance(value, list):
        raise TypeError(text)
    return [_CONVERT[kind](one) for one in value] if kind in _CONVERT else value


def _element(value: object) -> str:
    if isinstance(value, bytes):
        return str(value[0])
    return str(value).lower() if isinstance(value, bool) else repr(value)
