"""Generates `encode(message) -> payload` for a message class."""

from __future__ import annotations

import array
import reprlib
import struct
from typing import TYPE_CHECKING, Any, cast

from numpy import dtype as numpy_dtype

from course_kit.interfaces.codec import runtime
from course_kit.interfaces.codec.code_writer import HEADER_SIZE, CodeWriter
from course_kit.interfaces.field_checks import field_check
from course_kit.interfaces.message_fields import message_fields

if TYPE_CHECKING:
    import ctypes
    from collections.abc import Callable

    from course_kit.interfaces.field_types import FieldType, Primitive
    from course_kit.interfaces.message_fields import Message, MessageField

    Payload = bytes | bytearray | tuple[memoryview | array.array[Any], ...]
    Encode = Callable[[Message], Payload]

# The header announces little-endian XCDR1: two bytes 0 and 1, two of options.
_HEADER_FORMAT, _HEADER_VALUE = "I", "256"


LARGE = 4096  # elements of a sequence of numbers that is a part of its own


class Encoder(CodeWriter):
    """Writes code that appends a message's fields to a bytearray `b`; large ones become parts of a tuple."""

    def __init__(self) -> None:
        super().__init__()
        self._indent = 2
        self.formats, self.arguments = [_HEADER_FORMAT], [_HEADER_VALUE]
        self._started = False
        self._may_be_large = False

    def source(self, cls: type[Message]) -> str:
        """The function's source."""
        self._message(cls, "message")
        if self._started:
            self.flush()
            if self._may_be_large:
                self.emit("if parts: return (*parts, memoryview(b)[k:])")
            self.emit("return b")
        else:  # every value is of fixed size: one struct call makes the whole payload
            pack = self.constant("pack", struct.Struct("<" + "".join(self.formats)).pack)
            self.emit(f"return {pack}({', '.join(self.arguments)})")
        body = "\n".join(self.lines)
        start = "        parts, k = [], 0\n" if self._may_be_large else ""
        return (
            f"def encode(message):\n    try:\n{start}{body}\n"
            "    except Exception as error:\n        raise explained(message, error) from None\n"
        )

    def flush(self) -> None:
        """Write out the present batch."""
        if not self.formats:
            return
        pack = self.constant("pack", struct.Struct("<" + "".join(self.formats)).pack)
        call = f"{pack}({', '.join(self.arguments)})"
        self.emit(f"b += {call}" if self._started else f"b = bytearray({call})")
        self._started = True
        self.formats, self.arguments = [], []

    def align_at_run_time(self, align: int) -> None:
        """Pad; the header is 4 bytes long and does not count."""
        self.emit(f"b += PADDING[(4 - len(b)) & {align - 1}]")

    def _message(self, cls: type[Message], value: str) -> None:
        fields = message_fields(cls)
        if not fields:
            self.put("B", 1, 1, "0")
        for field in fields:
            self._field(field, f"{value}._{field.name}")

    def _field(self, field: MessageField, value: str) -> None:
        kind = field.type
        if kind.container == "array":
            self._array(field, value)
        elif kind.container == "sequence":
            self._sequence(field, value)
        elif kind.is_string:
            self._string(kind, value)
        elif field.nested is not None:
            message = self.variable("m")
            self.emit(f"{message} = {value}")
            self._message(field.nested, message)
        elif kind.primitive:
            self.put(kind.primitive.format, kind.primitive.size, kind.primitive.size, value)

    def _string(self, kind: FieldType, value: str) -> None:
        data = self.variable("s")
        if kind.base == "wstring":
            self.emit(f"{data} = {value}.encode('utf-16-le')")
            self.put("I", 4, 4, f"len({data}) // 2")
            self.flush()
            self.emit(f"b += struct_pack('<%dI' % (len({data}) // 2), *memoryview({data}).cast('H'))")
            self.settle(4)
            return
        self.emit(f"{data} = encode_string({value})")
        self.put("I", 4, 4, f"len({data}) + 1")
        self.flush()
        self.emit(f"b += {data}; b += NUL")
        self.settle(1)

    def _array(self, field: MessageField, value: str) -> None:
        primitive, count = field.type.primitive, field.type.size
        if field.type.base == "string":
            self.flush()
            self.align_at_run_time(4)
            self.emit(f"b += encode_strings(exactly({value}, {count}))")
            self.settle(1)
        elif primitive is None:
            self._each(field, f"exactly({value}, {count})")
        elif primitive.idl == "octet":
            self.put(f"{count}s", count, 1, f"encode_octets({value}, {count})")
        elif primitive.idl == "boolean":
            self.put(f"{count}?", count, 1, f"*{value}")
        else:
            dtype = self.constant("dtype", numpy_dtype(primitive.numpy).newbyteorder("<"))
            size = count * primitive.size
            self.put(f"{size}s", size, primitive.size, f"encode_fixed({value}, {dtype}, {count})")

    def _sequence(self, field: MessageField, value: str) -> None:
        values, bound = self.variable("v"), field.type.size
        self.emit(f"{values} = {value}")
        if bound:
            self.emit(f"if len({values}) > {bound}: too_long(len({values}), {bound})")
        self.put("I", 4, 4, f"len({values})")
        if field.type.primitive:
            self.flush()
            self._primitives(field.type.primitive, values)
        elif field.type.base == "string":
            self.flush()
            self.emit(f"if len({values}): b += encode_strings({values})")
            self.settle(1)
        else:
            self._each(field, values)

    def _primitives(self, primitive: Primitive, values: str) -> None:
        if primitive.idl == "octet":
            self.emit(f"if len({values}): b += list_octets({values}) or encode_octets({values}, len({values}))")
        elif primitive.idl == "boolean":
            self.emit(f"if len({values}): b += list_booleans({values}) or encode_booleans({values})")
        else:
            if primitive.size > HEADER_SIZE:  # an empty sequence is not padded
                self.emit(f"if len({values}): b += PADDING[(4 - len(b)) & 7]")
            code = primitive.array_code
            as_is = f"{values}.__class__ is array and {values}.typecode == '{code}'"
            self.emit(f"if not ({as_is}): {values} = array('{code}', {values})")
            self.emit(f"if len({values}) < {LARGE}: b += {values}")
            # An image is not copied into `b`. What follows it starts anew, with `k` bytes that only keep the alignment.
            self._may_be_large = True
            self.emit("else:")
            self.emit(f"    parts += memoryview(b)[k:], {values}")
            self.emit(f"    k = len(b) + {primitive.size} * len({values}) & 7; b = bytearray(k)")
        self.settle(min(primitive.size, 4))

    def _each(self, field: MessageField, values: str) -> None:
        self.flush()
        value = self.variable("x")
        self.emit(f"for {value} in {values}:")
        self.repeat(lambda: self._field(field._replace(type=field.type.element), value))


def make_encoder(cls: type[Message], native: ctypes.PyDLL | None = None) -> Encode:
    """Make the function that turns a message of `cls` into its CDR payload, header included."""
    writer = Encoder()
    source = writer.source(cls)
    namespace: dict[str, object] = {
        **writer.names,
        "array": array.array,
        "struct_pack": struct.pack,
        "NUL": b"\0",
        "PADDING": runtime.PADDING,
        "encode_string": runtime.encode_string,
        "encode_strings": runtime.encode_strings,
        "encode_booleans": runtime.encode_booleans,
        "encode_octets": runtime.encode_octets,
        "list_booleans": native.live_booleans if native else runtime.not_packed,
        "list_octets": native.live_octets if native else runtime.not_packed,
        "encode_fixed": runtime.encode_fixed,
        "exactly": runtime.exactly,
        "explained": explained,
        "too_long": runtime.too_long,
    }
    exec(compile(source, f"<CDR encoder of {cls.__module__}.{cls.__name__}>", "exec"), namespace)  # noqa: S102
    return cast("Encode", namespace["encode"])


def explained(message: Message, error: Exception) -> Exception:
    """The error that names the field which could not be encoded; the given one if no field is at fault."""
    for field in message_fields(type(message)):
        value: Any = getattr(message, f"_{field.name}", None)
        reason = _fault(field, value)
        if reason is not None:
            held = f"{reason}, and holds {reprlib.repr(value)}"
            return TypeError(f"{type(message).__name__} cannot be sent: {held[0].lower()}{held[1:]}.")
        if field.nested is None:
            continue
        for nested in value if field.type.container else (value,):
            found = explained(nested, error)
            if found is not error:
                return found
    return error


def _fault(field: MessageField, value: Any) -> str | None:
    try:
        field_check(field)(value)
    except (AssertionError, TypeError) as reason:
        return str(reason)
    # Compiled classes let this pass until the message is sent, too.
    if field.type.container and field.type.base == "octet" and any(len(item) != 1 for item in value):
        return f"The '{field.name}' field must hold bytes objects of length 1"
    return None
