"""Memory that outlives Python: DDS threads may read a type support until the process has ended."""

from __future__ import annotations

import ctypes

_libc = ctypes.CDLL(None)
_libc.malloc.restype, _libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]

_api = ctypes.pythonapi
_api.PyCapsule_New.restype = ctypes.py_object
_api.PyCapsule_New.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
_api.PyCapsule_GetPointer.restype = ctypes.c_void_p
_api.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
_api.Py_IncRef.argtypes = [ctypes.py_object]


def keep(data: bytes) -> int:
    """Copy bytes into memory that is never freed; the address."""
    address: int | None = _libc.malloc(max(len(data), 1))
    if address is None:
        raise MemoryError
    ctypes.memmove(address, data, len(data))
    return address


def keep_text(text: str) -> int:
    """Copy a C string into memory that is never freed; the address."""
    return keep(text.encode() + b"\0")


def keep_object(value: object) -> None:
    """Keep a Python object alive for ever, because C refers to it."""
    _api.Py_IncRef(value)


def capsule(address: int) -> object:
    """What rclpy expects to find a C address in: an unnamed capsule."""
    made: object = _api.PyCapsule_New(address, None, None)
    return made


def pointer(made: object) -> int:
    """The address inside an unnamed capsule."""
    address: int = _api.PyCapsule_GetPointer(made, None)
    return address
