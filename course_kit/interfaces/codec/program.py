"""The steps by which the native helper walks a payload to see whether it is what its type says.

The numbers are those of `enum step` in native/helper.c.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.interfaces.message_fields import message_fields

if TYPE_CHECKING:
    from course_kit.interfaces.message_fields import Message, MessageField

_RUN, _STRING, _WSTRING, _VALUES, _REPEAT, _REPEAT_LIST = range(1, 7)


def validation_program(cls: type[Message]) -> list[int]:
    """The program of a message class, nested messages included, as unsigned 32-bit words."""
    program = _Program()
    program.message(cls)
    return program.words


class _Program:
    def __init__(self) -> None:
        self.words: list[int] = []
        self._last_step = -1  # where the last step starts, if it may be extended

    def message(self, cls: type[Message]) -> None:
        fields = message_fields(cls)
        if not fields:
            self._fixed(1, 1)
        for field in fields:
            self._field(field)

    def _field(self, field: MessageField) -> None:
        kind = field.type
        if not kind.container:
            self._value(field)
        elif kind.primitive and kind.container == "array":
            self._fixed(kind.primitive.size, kind.size)
        elif kind.primitive:
            self._step(_VALUES, kind.primitive.size, kind.size)
        else:
            self._repeat(field)

    def _value(self, field: MessageField) -> None:
        kind = field.type
        if kind.primitive:
            self._fixed(kind.primitive.size, 1)
        elif field.nested is not None:
            self.message(field.nested)
        else:
            self._step(_WSTRING if kind.base == "wstring" else _STRING)

    def _fixed(self, size: int, count: int) -> None:
        step = [_RUN, size, size]
        if self._last_step >= 0 and self.words[self._last_step : -1] == step:
            self.words[-1] += count
        else:
            self._step(*step, count)

    def _repeat(self, field: MessageField) -> None:
        self._step(_REPEAT if field.type.container == "array" else _REPEAT_LIST, field.type.size, 0)
        start = len(self.words)
        self._last_step = -1  # the body is repeated, so nothing may be merged across its ends
        self._value(field)
        self._last_step = -1
        self.words[start - 1] = len(self.words) - start

    def _step(self, *words: int) -> None:
        self._last_step = len(self.words)
        self.words += words
