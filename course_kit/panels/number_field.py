"""A number inside a message, found by a path such as "linear.x" or "ranges[0]"."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit.lab.errors import FieldError
from course_kit.ros.filling import unknown_field
from course_kit.ros.messages import is_message_type, type_name

if TYPE_CHECKING:
    from course_kit.ros.messages import Message

_PART = re.compile(r"([A-Za-z_]\w*)((?:\[\d+\])*)")
_NUMBER = re.compile(r"(u?int\d+|float|double|boolean)")


class NumberField:
    """A path to a number in messages of a type."""

    def __init__(self, message_type: type[Message], path: str) -> None:
        if not is_message_type(message_type):
            raise FieldError(f"{getattr(message_type, '__name__', message_type)!r} is not a message type.")
        self.path = path
        self._steps: list[str | int] = []
        self._check(message_type)

    def of(self, message: Message) -> float | None:
        """The number; None in a message whose array is too short."""
        for step in self._steps:
            if isinstance(step, int):
                if step >= len(message):
                    return None
                message = message[step]
            else:
                message = getattr(message, step)
        return float(message)

    def _check(self, message_type: type[Message]) -> None:
        kind = type_name(message_type)
        current: type[Message] | None = message_type
        for part in self.path.split("."):
            found = _PART.fullmatch(part)
            if found is None:
                raise FieldError(
                    f"{self.path!r} is not a path to a field, such as 'data' or 'linear.x' or 'ranges[0]'."
                )
            name, indices = found[1], [int(one) for one in re.findall(r"\d+", found[2])]
            fields = current.get_fields_and_field_types() if current is not None else {}
            if name not in fields:
                raise FieldError(unknown_field(name, fields, f"a {kind}"))
            self._steps += [name, *indices]
            kind = _element_type(fields[name]) if indices else fields[name]
            current = _class_of(current, name, kind) if current is not None and "/" in kind else None
        if not _NUMBER.fullmatch(kind):
            raise FieldError(self._no_number(kind, current))

    def _no_number(self, kind: str, current: type[Message] | None) -> str:
        text = f"{self.path!r} is not a number but a {kind}."
        if current is not None:
            inside = list(current.get_fields_and_field_types())
            return f"{text} In it: {', '.join(f'{self.path}.{name}' for name in inside)}."
        return f"{text} Take one element: '{self.path}[0]'." if "[" in kind or "sequence" in kind else text


def _element_type(kind: str) -> str:
    """The type of an element of an array or a sequence; another type as it is."""
    sequence = re.fullmatch(r"sequence<([^,>]+)(?:, *\d+)?>", kind)
    return sequence[1] if sequence else re.sub(r"\[\d+\]$", "", kind)


def _class_of(owner: type[Message], name: str, kind: str) -> type[Message]:
    """The class of a message inside a message."""
    held = getattr(owner(), name)
    if is_message_type(type(held)):
        return type(held)
    from course_kit.interfaces import get_type

    package, _, bare = kind.partition("/")
    return get_type(f"{package}/msg/{bare.rpartition('/')[2]}")
