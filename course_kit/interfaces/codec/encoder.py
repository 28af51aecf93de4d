"""Generates `encode(message) -> payload` for a message class."""

from __future__ import annotations

import array
import reprlib
import struct
from typing import TYPE_CHECKING, Any, cast

from numpy import dtype as numpy_dtype
from numpy import frombuffer

from course_kit.interfaces.codec import code_writer
from course_kit.interfaces.codec.code_writer import HEADER_SIZE, CodeWriter
from course_kit.interfaces.field_checks import checks_by_default, field_check
from course_kit.interfaces.message_fields import message_fields

if TYPE_CHECKING:
    import ctypes
    from collections.abc import Callable

    from course_kit.interfaces.definition import FieldType, Primitive
    from course_kit.interfaces.message_fields import Message, MessageField

    Payload = bytes | bytearray | tuple[memoryview | array.array[Any], ...]
    Encode = Callable[[Message], Payload]
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
        head += f"    if u[1] != {_LITTLE_ENDIAN} or u[0]: refuse_encoding(u)\n"
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
        self.emit("if e > end: refuse_truncated()")
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
            self._decode_each(field, values, str(count))
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
            self.emit(f"if {length} > {bound}: refuse_too_long({length}, {bound})")
        if field.type.primitive:
            self._primitives(field.type.primitive, length, values)
        else:
            self._decode_each(field, values, length)
        return values

    def _primitives(self, primitive: Primitive, length: str, values: str) -> None:
        if primitive.size > HEADER_SIZE:  # an empty sequence is not padded
            self.emit(f"if {length}: o += (4 - o) & 7")
        self.emit(f"e = o + {length} * {primitive.size}")
        self.emit("if e > end: refuse_truncated()")
        if primitive.array_code:
            self.emit(f"{values} = array('{primitive.array_code}'); {values}.frombytes(memoryview(u)[o:e])")
        else:
            self.emit(f"{values} = {_elements(primitive, 'u[o:e]')}")
        self.emit("o = e")
        self.settle(min(primitive.size, 4))

    def _decode_each(self, field: MessageField, values: str, count: str) -> None:
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
        "octets": code_writer.OCTETS,
        "checks": checks_by_default(),
        "refuse_too_long": code_writer.refuse_too_long,
        "refuse_truncated": code_writer.refuse_truncated,
        "refuse_encoding": code_writer.refuse_encoding,
    }
    exec(compile(source, f"<CDR decoder of {cls.__module__}.{cls.__name__}>", "exec"), namespace)  # noqa: S102
    return cast("Decode", namespace["decode"])


# The header announces little-endian XCDR1: two bytes 0 and 1, two of options.
_HEADER_FORMAT, _HEADER_VALUE = "I", "256"


LARGE = 4096  # elements of a sequence of numbers that is a separate part


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
            self.emit(f"b += encode_strings(require_count({value}, {count}))")
            self.settle(1)
        elif primitive is None:
            self._encode_each(field, f"require_count({value}, {count})")
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
            self.emit(f"if len({values}) > {bound}: refuse_too_long(len({values}), {bound})")
        self.put("I", 4, 4, f"len({values})")
        if field.type.primitive:
            self.flush()
            self._primitives(field.type.primitive, values)
        elif field.type.base == "string":
            self.flush()
            self.emit(f"if len({values}): b += encode_strings({values})")
            self.settle(1)
        else:
            self._encode_each(field, values)

    def _primitives(self, primitive: Primitive, values: str) -> None:
        if primitive.idl == "octet":
            self.emit(f"if len({values}): b += list_octets({values}) or encode_octets({values}, len({values}))")
        elif primitive.idl == "boolean":
            self.emit(f"if len({values}): b += list_booleans({values}) or bytes(map(bool, {values}))")
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

    def _encode_each(self, field: MessageField, values: str) -> None:
        self.flush()
        value = self.variable("x")
        self.emit(f"for {value} in {values}:")
        self.repeat(lambda: self._field(field._replace(type=field.type.element), value))


def make_encoder(cls: type[Message], native: ctypes.PyDLL) -> Encode:
    """Make the function that turns a message of `cls` into its CDR payload, header included."""
    writer = Encoder()
    source = writer.source(cls)
    namespace: dict[str, object] = {
        **writer.names,
        "array": array.array,
        "struct_pack": struct.pack,
        "NUL": b"\0",
        "PADDING": code_writer.PADDING,
        "encode_string": code_writer.encode_string,
        "encode_strings": code_writer.encode_strings,
        "encode_octets": code_writer.encode_octets,
        "list_booleans": native.live_booleans,
        "list_octets": native.live_octets,
        "encode_fixed": code_writer.encode_fixed,
        "require_count": code_writer.require_count,
        "explained": explain_error,
        "refuse_too_long": code_writer.refuse_too_long,
    }
    exec(compile(source, f"<CDR encoder of {cls.__module__}.{cls.__name__}>", "exec"), namespace)  # noqa: S102
    return cast("Encode", namespace["encode"])


def explain_error(message: Message, error: Exception) -> Exception:
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
            found = explain_error(nested, error)
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
