"""What comes back compared with what is expected, and both in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading.model.exchange_log import in_one_line
from course_kit.ros.filling import make_message
from course_kit.ros.messages import is_message_type, type_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.ros.messages import Message

_RELATIVE, _ABSOLUTE = 1e-6, 1e-9  # the right formula, whatever has become of the last digits


@dataclass(frozen=True)
class Approximation:
    """A number that is expected with another accuracy than 1e-6 relative or 1e-9 absolute.

    Attributes:
        value: the number.
        relative: how far off it may be, as a share of the value.
        absolute: the same in the value's unit; the larger one counts.

    Example:
        >>> node.call("/area", radius=2.0).expect(area=Approximation(12.566, absolute=0.01))
    """

    value: float
    relative: float = 0.0
    absolute: float = 0.0

    def __call__(self, got: Any) -> bool:
        """Whether a number is close enough."""
        return math.isclose(got, self.value, rel_tol=self.relative, abs_tol=self.absolute)


def differences(wanted: Any, got: Any, path: str = "") -> Iterator[tuple[str, Any, Any]]:
    """The fields that are not as expected: path, what was wanted, what came.

    Args:
        wanted: a dict of fields, a value, or a function that says whether a value is right.
        got: a message, or a field of one.
        path: of the field.
    """
    if isinstance(wanted, dict):
        for name, value in wanted.items():
            yield from differences(value, getattr(got, name), f"{path}.{name}" if path else name)
    elif is_message_type(type(wanted)):
        for name in wanted.get_fields_and_field_types():
            yield from differences(getattr(wanted, name), getattr(got, name), f"{path}.{name}" if path else name)
    elif not _fits(wanted, got):
        yield path, wanted, got


def _fits(wanted: Any, got: Any) -> bool:
    if callable(wanted):
        return bool(wanted(got))
    if isinstance(wanted, float):
        if math.isnan(wanted):
            return math.isnan(got)
        return math.isclose(wanted, got, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)
    if isinstance(wanted, (list, tuple)):
        return len(wanted) == len(got) and all(map(_fits, wanted, got))
    return bool(wanted == got)


def describe_wanted(wanted: Any) -> str:
    """What is expected in words, `success=True, value=32.0`."""
    if is_message_type(type(wanted)):
        return in_one_line(wanted)
    if isinstance(wanted, dict):
        return ", ".join(f"{name}={describe_wanted(value)}" for name, value in wanted.items())
    if isinstance(wanted, Approximation):
        return repr(wanted.value)
    return "what the task says" if callable(wanted) else repr(wanted)


def message_of(message_type: Any, given: Any, fields: dict[str, Any]) -> Message:
    """A message with the fields that somebody has written.

    Args:
        message_type: its class.
        given: a message, a dict of fields, the value of its only field, or None.
        fields: more of them.

    Raises:
        BadFieldError: a field is not there, or takes no such value.
    """
    if isinstance(given, message_type):
        return given
    names = list(message_type.get_fields_and_field_types())
    if given is not None and not isinstance(given, dict):
        if len(names) != 1:
            raise TypeError(f"{type_name(message_type)} has {len(names)} fields: say which, as a dict")
        given = {names[0]: given}
    return make_message(message_type, {**(given or {}), **fields}, type_name(message_type))


def only_field(message: Message, wanted: Any) -> Any:
    """What is expected of a message, written as the value of its only field or not."""
    names = list(message.get_fields_and_field_types())
    whole = callable(wanted) and not isinstance(wanted, Approximation)
    if isinstance(wanted, dict) or whole or is_message_type(type(wanted)) or len(names) != 1:
        return wanted
    return {names[0]: wanted}
