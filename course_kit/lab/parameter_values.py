"""Parameters as Python values, in words: what a node has, what came of setting it, what may be set.

A parameter's value is a bool, an int, a float, a str, or a list of one of these or of bytes; the types are those of
rcl_interfaces/msg/ParameterType.
"""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass
from typing import Any, NamedTuple

from course_kit.lab.errors import FieldError

# By rcl_interfaces/msg/ParameterType: the type's name, and the field of ParameterValue that holds the value.
KINDS = {
    0: ("not set", ""),
    1: ("bool", "bool_value"),
    2: ("integer", "integer_value"),
    3: ("double", "double_value"),
    4: ("string", "string_value"),
    5: ("byte_array", "byte_array_value"),
    6: ("bool_array", "bool_array_value"),
    7: ("integer_array", "integer_array_value"),
    8: ("double_array", "double_array_value"),
    9: ("string_array", "string_array_value"),
}
_SCALARS: tuple[tuple[type, int], ...] = (
    (bool, 1),
    (int, 2),
    (float, 3),
    (str, 4),
)  # a bool is an int as well: it comes first
_ELEMENTS: tuple[tuple[type, int], ...] = ((bytes, 5), (bool, 6), (int, 7), (float, 8), (str, 9))
_INT64 = range(-(2**63), 2**63)
# Every node has these, whatever its author declares.
_OF_EVERY_NODE = ("use_sim_time", "start_type_description_service")
_OVERRIDES = "qos_overrides."


class Values(dict[str, Any]):
    """Values by name that print one a line."""

    def __repr__(self) -> str:
        return "\n".join(f"{name}: {value!r}" for name, value in self.items()) or "no parameters"

    __str__ = __repr__


class Outcome:
    """What came of setting parameters; true if all were set.

    Attributes:
        node: the node's full name.
        values: what was asked for, by name.
        reasons: why the node refused, by name; in the node's own words where it has any.
    """

    def __init__(self, node: str, values: dict[str, Any], reasons: dict[str, str], *, atomically: bool) -> None:
        self.node = node
        self.values = values
        self.reasons = reasons
        self._atomically = atomically

    @property
    def successful(self) -> bool:
        """Whether every parameter was set."""
        return not self.reasons

    @property
    def events(self) -> int:
        """How many messages on /parameter_events tell of it."""
        return int(self.successful) if self._atomically else len(self.values) - len(self.reasons)

    def __bool__(self) -> bool:
        return self.successful

    def __repr__(self) -> str:
        if self._atomically and self.reasons:
            reason = next(iter(self.reasons.values()))
            return f"nothing was set, because one value was refused: {reason}"
        return "\n".join(self._line(name) for name in self.values)

    def _line(self, name: str) -> str:
        value = self.values[name]
        if name not in self.reasons:
            return f"{name}: set to {value!r}"
        reason = self.reasons[name]
        return f"{name}: {value!r} was refused: {reason}{_hint(value, reason)}"


class Range(NamedTuple):
    """Limits of a number, both allowed; a step of 0 means any value between."""

    lowest: float
    highest: float
    step: float

    def __str__(self) -> str:
        steps = f" in steps of {self.step!r}" if self.step else ""
        return f"{self.lowest!r} to {self.highest!r}{steps}"


@dataclass(frozen=True, repr=False)
class Descriptor:
    """What a node says about one of its parameters.

    Attributes:
        name: of the parameter.
        type: such as "double"; see `KINDS`.
        description: what it is for; may be empty.
        range: limits of a number, None without any.
        read_only: whether it cannot be changed after the start.
        constraints: what else its author asks of values, in words; may be empty.
    """

    name: str
    type: str
    description: str
    range: Range | None
    read_only: bool
    constraints: str

    def __repr__(self) -> str:
        facts = [self.type, str(self.range) if self.range else "", "read-only" if self.read_only else ""]
        words = [f"{self.name}: {', '.join(fact for fact in facts if fact)}"]
        words += [f"    {text}" for text in (self.description, self.constraints) if text]
        return "\n".join(words)


class Descriptors(list[Descriptor]):
    """Descriptors that print one after the other."""

    def __repr__(self) -> str:
        return "\n".join(str(one) for one in self) or "no parameters"

    __str__ = __repr__


def own_first(names: list[str]) -> list[str]:
    """The node's own parameters in its order, then those that ROS 2 declares in every node."""
    return [name for name in names if not is_of_every_node(name)] + [name for name in names if is_of_every_node(name)]


def is_of_every_node(name: str) -> bool:
    """Whether ROS 2 declares this parameter, not the node's author."""
    return name in _OF_EVERY_NODE or name.startswith(_OVERRIDES)


def is_empty_list(value: Any) -> bool:
    """Whether this is a list without elements, which does not say what it is a list of."""
    return not isinstance(value, str) and hasattr(value, "__len__") and len(value) == 0


def to_message(name: str, value: Any, empty_list: int | None = None) -> Any:
    """The rcl_interfaces/msg/Parameter for a value; None for "not set", which deletes a dynamic one.

    Args:
        name: of the parameter.
        value: numbers and arrays of numpy are welcome.
        empty_list: the type of an empty list; bytes when nobody knows, as in rclpy.

    Raises:
        FieldError: no parameter can have such a value.
    """
    from rcl_interfaces.msg import Parameter, ParameterValue

    if hasattr(value, "tolist"):  # numpy's, and array.array's, which is what arrays come back as
        value = value.tolist()
    kind = _kind_of(name, value, empty_list or _ELEMENTS[0][1])
    message = ParameterValue(type=kind)
    field = KINDS[kind][1]
    if field:
        setattr(message, field, list(value) if isinstance(value, (list, tuple)) else value)
    return Parameter(name=name, value=message)


def from_message(value: Any) -> Any:
    """What an rcl_interfaces/msg/ParameterValue holds, arrays as lists; None when it is not set."""
    field = KINDS[value.type][1]
    held: Any = getattr(value, field) if field else None
    return list(held) if value.type >= _ELEMENTS[0][1] else held


def described(message: Any) -> Descriptor:
    """An rcl_interfaces/msg/ParameterDescriptor in plain values."""
    limits = [*message.floating_point_range, *message.integer_range]
    found = Range(limits[0].from_value, limits[0].to_value, limits[0].step) if limits else None
    return Descriptor(
        message.name,
        KINDS[message.type][0],
        message.description,
        found,
        message.read_only,
        message.additional_constraints,
    )


def _kind_of(name: str, value: Any, empty_list: int) -> int:
    if value is None:
        return 0
    for kind, number in _SCALARS:
        if isinstance(value, kind):
            _require_int64(name, [value])
            return number
    if not isinstance(value, (list, tuple)):
        raise FieldError(
            _unfit(name, value, "A parameter is a bool, an int, a float, a str, or a list of one of these")
        )
    if not value:
        return empty_list
    for kind, number in _ELEMENTS:
        if all(isinstance(one, kind) and (kind is bool or not isinstance(one, bool)) for one in value):
            _require_int64(name, value)
            return number
    hint = ""
    if all(isinstance(one, (int, float)) and not isinstance(one, bool) for one in value):
        hint = f" Write {[float(one) for one in value]!r}."
    raise FieldError(_unfit(name, value, "All elements of a list have one type: bool, int, float, str or bytes") + hint)


def _require_int64(name: str, values: Any) -> None:
    if any(isinstance(one, int) and one not in _INT64 for one in values):
        raise FieldError(_unfit(name, values[0], "An integer parameter has 64 bits"))


def _unfit(name: str, value: Any, rule: str) -> str:
    shown = textwrap.shorten(repr(value), 60, placeholder="...")
    return f"{rule}; {name!r} was given {shown}, {_article(type(value).__name__)}."


def _article(word: str) -> str:
    return f"{'an' if word[0] in 'aeio' else 'a'} {word}"


def _hint(value: Any, reason: str) -> str:
    """For the slip everybody makes: 1 is an integer, and a double does not take it."""
    if type(value) is int and re.match(r"wrong parameter type.*double", reason, re.IGNORECASE):
        return f". {value} is an integer: write {float(value)}"
    return ""
