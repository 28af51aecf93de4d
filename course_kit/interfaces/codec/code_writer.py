"""Common ground of encoder and decoder: lines of code, and what is known about alignment at each point.

CDR aligns a value to its size, counted from behind the 4-byte header. Between values of variable size the exact
position is unknown, yet often known modulo 4 or 8; so padding is mostly settled while the code is generated.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, NoReturn, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import ArrayLike

_Values = TypeVar("_Values", bound="Sequence[object]")
PADDING = [bytes(count) for count in range(8)]
OCTETS = [bytes([value]) for value in range(256)]
_LENGTH = struct.Struct("<I").pack


def refuse_too_long(length: int, bound: int) -> NoReturn:
    """Refuse a sequence beyond its bound."""
    raise ValueError(f"a sequence of {length} elements exceeds its bound of {bound}")


def refuse_encoding(payload: bytes | memoryview) -> NoReturn:
    """Refuse a payload that is not plain little-endian CDR."""
    raise ValueError(f"unknown encapsulation {bytes(payload[:2]).hex()} of a serialized message")


def refuse_truncated() -> NoReturn:
    """Refuse a payload that ends too early."""
    raise ValueError("the serialized message is truncated")


def encode_string(value: str) -> bytes:
    """UTF-8 up to the first NUL, where a C string ends."""
    data = value.encode()
    return data[: data.index(0)] if 0 in data else data


def encode_strings(values: Sequence[str]) -> bytes:
    """Strings one after another, each with its length, NUL and what keeps the next one aligned."""
    encoded = [encode_string(value) for value in values]
    packed = [_LENGTH(len(data) + 1) + data + PADDING[4 - len(data) % 4] for data in encoded]
    if packed:
        packed[-1] = packed[-1][: 4 + len(encoded[-1]) + 1]  # what follows knows its own alignment
    return b"".join(packed)


def encode_octets(values: Sequence[bytes], count: int) -> bytes:
    """A list of one-byte objects as bytes."""
    data = b"".join(values)
    if len(data) != count or len(values) != count:
        raise ValueError(f"expected {count} bytes objects of length 1 each")
    return data


def encode_fixed(values: ArrayLike, dtype: np.dtype[np.generic], count: int) -> bytes:
    """A fixed array of numbers."""
    array = np.asarray(values, dtype)
    if array.size != count:
        raise ValueError(f"the array must have {count} elements, not {array.size}")
    return array.tobytes()


def require_count(values: _Values, count: int) -> _Values:
    """The values themselves, if there are `count` of them."""
    if len(values) != count:
        raise ValueError(f"the array must have {count} elements, not {len(values)}")
    return values


HEADER_SIZE = 4  # encapsulation: byte order and options


class CodeWriter:
    """Writes the body of one function, batching fixed-size values into single struct calls."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.names: dict[str, object] = {}  # constants the generated code refers to
        self._indent = 1
        self._variables = 0
        # The position is known to be `remainder` modulo `modulus`.
        self.modulus, self.remainder = 8, 0
        self.formats: list[str] = []
        self.arguments: list[str] = []

    def variable(self, prefix: str) -> str:
        """A name not used before."""
        self._variables += 1
        return f"{prefix}{self._variables}"

    def emit(self, line: str) -> None:
        """Add a line at the present indentation."""
        self.lines.append("    " * self._indent + line)

    def constant(self, prefix: str, value: object) -> str:
        """A name for an object in the generated code; the same object gets the same name."""
        for name, known in self.names.items():
            if known is value:
                return name
        name = f"{prefix}{len(self.names)}"
        self.names[name] = value
        return name

    def put(self, code: str, size: int, align: int, argument: str) -> None:
        """Add a value of fixed size to the present batch."""
        if self.modulus >= align:
            padding = -self.remainder % align
            if padding:
                self.formats.append(f"{padding}x")
                self._advance(padding)
        else:
            self.flush()
            self.align_at_run_time(align)
            self.modulus, self.remainder = align, 0
        self.formats.append(code)
        self.arguments.append(argument)
        self._advance(size)

    def settle(self, modulus: int) -> None:
        """From here on the position is known to be a multiple of `modulus` (at most 4: the header counts)."""
        self.modulus, self.remainder = modulus, 0

    def repeat(self, body: Callable[[], None]) -> None:
        """Write the body of a loop so that it is right in its every round, whatever it does to the alignment."""
        self.flush()
        entry = known = (self.modulus, self.remainder)
        while True:
            before = (self.lines, self._variables, dict(self.names))
            self.lines = []
            self.modulus, self.remainder = known
            self._indent += 1
            body()
            self.flush()
            self._indent -= 1
            leaving = _common(known, (self.modulus, self.remainder))
            if leaving == known:
                self.lines = before[0] + self.lines
                self.modulus, self.remainder = _common(entry, leaving)
                return
            self.lines, self._variables, self.names = before
            known = leaving

    def flush(self) -> None:
        """Write out the present batch."""
        raise NotImplementedError

    def align_at_run_time(self, align: int) -> None:
        """Write code that aligns a position unknown until then."""
        raise NotImplementedError

    def _advance(self, size: int) -> None:
        self.remainder = (self.remainder + size) % self.modulus


def _common(a: tuple[int, int], b: tuple[int, int]) -> tuple[int, int]:
    """What two states of knowledge about the position have in common."""
    modulus = min(a[0], b[0])
    while modulus > 1 and a[1] % modulus != b[1] % modulus:
        modulus //= 2
    return modulus, a[1] % modulus
