"""Names in a zip that are said to be UTF-8 and are not, and additions to them that are damaged.

Python's reader gives the whole archive up for one of them, and with it the whole class. Here such a name is read as
the old zip encoding instead, and such an addition is passed over; if the file cannot be had that way, that is the
problem of this one file.
"""

from __future__ import annotations

import io
import struct
import zipfile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_SIGNATURE = b"PK\x01\x02"  # of an entry in the list of names at the end of a zip
_HEAD = 46  # bytes before the name
_FLAGS_AT, _LENGTHS_AT = 8, 28
_UTF_8 = 0x800
_FIELD = 4  # bytes before each addition: its kind and its length
_NAME_IN_UNICODE, _UNKNOWN = 0x7075, 0xFFFF
_MOST_FIELDS = 100  # additions to a name; Python copies what follows each of them
_BEFORE_NAME = 5  # bytes: a version, a checksum


class NamesReader(io.BufferedReader):
    """A zip's bytes, in whose list of names each name is what it says it is."""

    def __init__(self, path: Path, most: int) -> None:
        super().__init__(io.FileIO(path))
        self._mends = True
        self._most = most

    def read(self, size: int | None = -1, /) -> bytes:
        """As every file does it."""
        if self._mends and size is not None and size > self._most:
            raise zipfile.BadZipFile(f"it lists too many files (their names take more than {self._most >> 20} MB)")
        data = super().read(size)
        return _mended(data) if self._mends and data.startswith(_SIGNATURE) else data

    def names_are_read(self) -> None:
        """From here on everything is read as it is."""
        self._mends = False


def _mended(names: bytes) -> bytes:
    data = bytearray(names)
    place = 0
    while data[place : place + len(_SIGNATURE)] == _SIGNATURE and place + _HEAD <= len(data):
        (flags,) = struct.unpack_from("<H", data, place + _FLAGS_AT)
        name, extra, comment = struct.unpack_from("<HHH", data, place + _LENGTHS_AT)
        start = place + _HEAD
        if flags & _UTF_8 and not _is_utf_8(data[start : start + name]):
            struct.pack_into("<H", data, place + _FLAGS_AT, flags & ~_UTF_8)
        start += name
        if extra >= _FIELD and start + extra <= len(data) and not _is_sound(data[start : start + extra]):
            struct.pack_into("<HH", data, start, _UNKNOWN, extra - _FIELD)
        place = start + extra + comment
    return bytes(data)


def _is_utf_8(name: bytearray) -> bool:
    try:
        name.decode()
    except UnicodeDecodeError:
        return False
    return True


def _is_sound(extra: bytearray) -> bool:
    """Whether additions to a name are few, as long as they say, and hold a name where they promise one."""
    place = fields = 0
    while place + _FIELD <= len(extra):
        kind, length = struct.unpack_from("<HH", extra, place)
        place += _FIELD
        content = extra[place : place + length]
        fields += 1
        if len(content) < length or fields > _MOST_FIELDS:
            return False
        if kind == _NAME_IN_UNICODE and (length < _BEFORE_NAME or not _is_utf_8(content[_BEFORE_NAME:])):
            return False
        place += length
    return True
