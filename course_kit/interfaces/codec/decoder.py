"""Generates `decode(payload) -> message` for a message class."""

from __future__ import annotations

import array
import struct
from typing import TYPE_CHECKING, cast

from numpy import dtype as numpy_dtype
from numpy import frombuffer

from course_kit.interfaces.codec import runtime
from course_kit.interfaces.codec.code_writer import HEADER_SIZE, CodeWriter
from course_kit.interfaces.field_checks import checks_by_default
from course_kit.interfaces.message_fields import message_fields

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.interfaces.field_types import FieldType, Primitive
    from course_kit.interfaces.message_fields import Message, MessageField

    Decode = Callable[[bytes | memoryview], Message]

_LITTLE_ENDIAN = 1  # the second byte of a payload; what Fast DDS on this machine's kind of processor writes


class Decoder(CodeWriter):
    """Writes code that reads bytes, or a view of them, `u` from offset `o` on; `end` is the payload's length."""

    def __init__(self) -> None:
        super().__init__()
        self._after: list[str] = []  # lines that need the values of the present batch

    def source(self, cls: type[Message]) -> str:
        """The function's source."""
        result = self._message(cls)
        self.flush()
        self.emit(f"return {result}")
        head = "def decode(u):\n    o, end = 4, len(u)\n"
        head += f"    if u[1] != {_LITTLE_ENDIAN} or u[0]: unknown_encoding(u)\n"
        return head + "\n".join(self.lines) + "\n"

    def flush(self) -> None:
        """Write out the present batch."""
        if self.formats:
            batch = struct.Struct("<" + "".join(self.formats))
            unpack = self.constant("unpack", batch.unpack_from)
            self.emit(f"{', '.join(self.arguments)}, = {unpack}(u, o)")
            self.emit(f"o += {batch.size}")
            self.formats, self.arguments = [], []
        for line in self._after:
            self.emit(line)
        self._after = []

    def align_at_run_time(self, align: int) -> None:
        """Skip padding; the header is 4 bytes long and does not count."""
        self.emit(f"o += (4 - o) & {align - 1}")

    def _message(self, cls: type[Message]) -> str:
        result = self.variable("m")
        fields = message_fields(cls)
        if not fields:
            self.put("B", 1, 1, "_")
        values = [(field.name, self._field(field)) for field in fields]
        # Fields are set behind the properties: what came over the wire needs no check.
        self._after.append(f"{result} = new({self.constant('cls', cls)})")
        if "_check_fields" in getattr(cls, "__slots__", ()):
            self._after.append(f"{result}._check_fields = checks")
        self._after += [f"{result}._{name} = {value}" for name, value in values]
        return result

    def _field(self, field: MessageField) -> str:
        kind = field.type
        if kind.container == "array":
            return self._array(field)
        if kind.container == "sequence":
            return self._sequence(field)
        if field.nested is not None:
            return self._message(field.nested)
        if kind.primitive is None:
            return self._string(kind)
        value = self.variable("v")
        self.put(kind.primitive.format, kind.primitive.size, kind.primitive.size, value)
        return value

    def _string(self, kind: FieldType) -> str:
        value, length = self.variable("s"), self.variable("n")
        wide = kind.base == "wstring"
        self.put("I", 4, 4, length)
        self.flush()
        self.emit(f"e = o + 4 * {length}" if wide else f"e = o + {length}")
        self.emit("if e > end: truncated()")
        if wide:
            units = f"struct_unpack('<%dI' % {length}, u, o)"
            self.emit(f"{value} = struct_pack('<%dH' % {length}, *{units}).decode('utf-16-le')")
        else:
            self.emit(f"{value} = str(u[o:e], 'utf-8', 'replace').partition(NUL)[0]")
        self.emit("o = e")
        self.settle(4 if wide else 1)
        return value

    def _array(self, field: MessageField) -> str:
        primitive, count = field.type.primitive, field.type.size
        values = self.variable("a")
        if primitive is None:
            self._each(field, values, str(count))
            return values
        size = count * primitive.size
        self.put(f"{size}s", size, primitive.size, values)
        if primitive.array_code:
            dtype = self.constant("dtype", numpy_dtype(primitive.numpy))
            self._after.append(f"{values} = from_buffer({values}, {dtype}).copy()")
        else:
            self._after.append(f"{values} = {_elements(primitive, values)}")
        return values

    def _sequence(self, field: MessageField) -> str:
        length, values, bound = self.variable("n"), self.variable("q"), field.type.size
        self.put("I", 4, 4, length)
        self.flush()
        if bound:
            self.emit(f"if {length} > {bound}: too_long({length}, {bound})")
        if field.type.primitive:
            self._primitives(field.type.primitive, length, values)
        else:
            self._each(field, values, length)
        return values

    def _primitives(self, primitive: Primitive, length: str, values: str) -> None:
        if primitive.size > HEADER_SIZE:  # an empty sequence is not padded
            self.emit(f"if {length}: o += (4 - o) & 7")
        self.emit(f"e = o + {length} * {primitive.size}")
        self.emit("if e > end: truncated()")
        if primitive.array_code:
            self.emit(f"{values} = array('{primitive.array_code}'); {values}.frombytes(memoryview(u)[o:e])")
        else:
            self.emit(f"{values} = {_elements(primitive, 'u[o:e]')}")
        self.emit("o = e")
        self.settle(min(primitive.size, 4))

    def _each(self, field: MessageField, values: str, count: str) -> None:
        self.flush()
        self.emit(f"{values} = []")
        self.emit(f"for _ in range({count}):")

        def body() -> None:
            value = self._field(field._replace(type=field.type.element))
            self.flush()
            self.emit(f"{values}.append({value})")

        self.repeat(body)


def _elements(primitive: Primitive, data: str) -> str:
    """Code for a list of bytes objects of length 1, or of booleans."""
    if primitive.idl == "octet":
        return f"[octets[i] for i in {data}]"
    return f"[i != 0 for i in {data}]"


def make_decoder(cls: type[Message]) -> Decode:
    """Make the function that turns a CDR payload, header included, into a message of `cls`."""
    writer = Decoder()
    source = writer.source(cls)
    namespace: dict[str, object] = {
        **writer.names,
        "array": array.array,
        "struct_pack": struct.pack,
        "struct_unpack": struct.unpack_from,
        "NUL": "\0",
        "from_buffer": frombuffer,
        "new": object.__new__,
        "octets": runtime.OCTETS,
        "checks": checks_by_default(),
        "too_long": runtime.too_long,
        "truncated": runtime.truncated,
        "unknown_encoding": runtime.unknown_encoding,
    }
    exec(compile(source, f"<CDR decoder of {cls.__module__}.{cls.__name__}>", "exec"), namespace)  # noqa: S102
    return cast("Decode", namespace["decode"])
