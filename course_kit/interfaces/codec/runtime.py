"""Functions the generated encoders and decoders call."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, NoReturn, TypeVar

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

_Values = TypeVar("_Values", bound="Sequence[object]")
PADDING = [bytes(count) for count in range(8)]
OCTETS = [bytes([value]) for value in range(256)]
_LENGTH = struct.Struct("<I").pack
_SHORT = [struct.Struct(f"<I{size + 4 - size % 4}s").pack for size in range(64)]  # of strings by their length


def too_long(length: int, bound: int) -> NoReturn:
    """Refuse a sequence beyond its bound."""
    raise ValueError(f"a sequence of {length} elements exceeds its bound of {bound}")


def unknown_encoding(payload: bytes | memoryview) -> NoReturn:
    """Refuse a payload that is not plain little-endian CDR."""
    raise ValueError(f"unknown encapsulation {bytes(payload[:2]).hex()} of a serialized message")


def truncated() -> NoReturn:
    """Refuse a payload that ends too early."""
    raise ValueError("the serialized message is truncated")


def encode_string(value: str) -> bytes:
    """UTF-8 up to the first NUL, where a C string ends."""
    data = value.encode()
    return data[: data.index(0)] if 0 in data else data


def encode_strings(values: Sequence[str]) -> bytes:
    """Strings one after another, each with its length, NUL and what keeps the next one aligned."""
    try:
        encoded = "\0".join(values).encode().split(b"\0")
        plain = len(encoded) == len(values)
    except TypeError:  # not of str itself; with the checks off
        plain = False
    if not plain:
        encoded = [encode_string(value) for value in values]
    short = _SHORT
    try:
        packed = [short[len(data)](len(data) + 1, data) for data in encoded]
    except IndexError:
        packed = [_LENGTH(len(data) + 1) + data + PADDING[4 - len(data) % 4] for data in encoded]
    if packed:
        packed[-1] = packed[-1][: 4 + len(encoded[-1]) + 1]  # what follows knows its own alignment
    return b"".join(packed)


def not_packed(values: object) -> None:
    """Stands where there is no native helper to pack a list."""
    del values


def encode_booleans(values: Sequence[bool]) -> bytes:
    """A list of booleans as bytes 0 and 1."""
    try:
        data = bytes(values)
    except (TypeError, ValueError):  # not of booleans; with the checks off
        return bytes(map(bool, values))
    return bytes(map(bool, data)) if data.translate(None, b"\0\1") else data


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


def exactly(values: _Values, count: int) -> _Values:
    """The values themselves, if there are `count` of them."""
    if len(values) != count:
        raise ValueError(f"the array must have {count} elements, not {len(values)}")
    return values
