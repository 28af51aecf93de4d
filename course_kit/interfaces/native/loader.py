"""Loads the native helper and hands it what it needs of Python and of Fast CDR.

Where Fast CDR keeps its buffer is found on a live object, not assumed; a layout this code does not know ends in a
message for people instead of a crash.
"""

from __future__ import annotations

import ctypes
import struct
import sys
import zlib
from pathlib import Path
from typing import Any

from course_kit.environment import middleware
from course_kit.interfaces.errors import NativeHelperError

_libc = ctypes.CDLL(None)
_libc.malloc.restype, _libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]

_api = ctypes.pythonapi
_api.PyCapsule_New.restype = ctypes.py_object
_api.PyCapsule_New.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
_api.PyCapsule_GetPointer.restype = ctypes.c_void_p
_api.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
_api.Py_IncRef.argtypes = [ctypes.py_object]


def keep_data(data: bytes) -> int:
    """Copy bytes into memory that is never freed; the address."""
    address: int | None = _libc.malloc(max(len(data), 1))
    if address is None:
        raise MemoryError
    ctypes.memmove(address, data, len(data))
    return address


def keep_text(text: str) -> int:
    """Copy a C string into memory that is never freed; the address."""
    return keep_data(text.encode() + b"\0")


def keep_object(value: object) -> None:
    """Keep a Python object alive for ever, because C refers to it."""
    _api.Py_IncRef(value)


def make_capsule(address: int) -> object:
    """What rclpy expects to find a C address in: an unnamed capsule."""
    made: object = _api.PyCapsule_New(address, None, None)
    return made


def capsule_pointer(made: object) -> int:
    """The address inside an unnamed capsule."""
    address: int = _api.PyCapsule_GetPointer(made, None)
    return address


LIBRARY = Path(__file__).with_name("_helper.so")
SOURCE = LIBRARY.with_name("helper.c")
LEAVING = LIBRARY.with_name("leaving.c")

_POSITION = "_ZN8eprosima7fastcdr3Cdr20get_current_positionEv"
_JUMP = "_ZN8eprosima7fastcdr3Cdr4jumpEm"
_NEW_BUFFER = "_ZN8eprosima7fastcdr10FastBufferC1EPcm"
_NEW_CDR = "_ZN8eprosima7fastcdr3CdrC1ERNS0_10FastBufferENS1_10EndiannessENS0_10CdrVersionE"
_LITTLE_ENDIAN, _XCDR_V1 = 1, 2

_address, _text, _size, _object = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t, ctypes.py_object


_PYTHON_FUNCTIONS = (
    "PyObject_CallFunctionObjArgs",
    "PyBytes_FromStringAndSize",
    "PyMemoryView_FromMemory",
    "PyObject_CallMethodObjArgs",
    "PyObject_GetBuffer",
    "PyBuffer_Release",
    "PyObject_CheckBuffer",
    "PyTuple_Size",
    "PyTuple_GetItem",
    "PyBytes_AsString",
    "Py_IncRef",
    "Py_DecRef",
    "PyErr_NoMemory",
    "PyErr_Fetch",
    "PyErr_Restore",
    "PyErr_WriteUnraisable",
    "PyGILState_Ensure",
    "PyGILState_Release",
)


class Imports(ctypes.Structure):
    """`struct imports` of helper.c."""

    _fields_ = (
        ("cdr_position", ctypes.c_void_p),
        ("cdr_jump", ctypes.c_void_p),
        ("buffer_in_cdr", ctypes.c_size_t),
        ("data_in_buffer", ctypes.c_size_t),
        ("size_in_buffer", ctypes.c_size_t),
        ("set_error", ctypes.c_void_p),
        ("none", ctypes.c_void_p),
        ("release", ctypes.c_void_p),
        *((name, ctypes.c_void_p) for name in ("list", "bytes", "yes", "no")),
        ("items_in_list", ctypes.c_size_t),
        ("data_in_bytes", ctypes.c_size_t),
        *((name, ctypes.c_void_p) for name in _PYTHON_FUNCTIONS),
    )


_SIGNATURES: dict[str, tuple[Any, list[Any]]] = {
    "live_setup": (None, [ctypes.POINTER(Imports)]),
    "live_new_type": (_address, [_address, _address, _size, _object, _object]),
    "live_create_function": (_address, [_address]),
    "live_booleans": (_object, [_object]),
    "live_octets": (_object, [_object]),
    "live_valid": (ctypes.c_bool, [_address, _text, _size]),
    "live_message_support": (_address, [_address, _address, _address, _address]),
    "live_new_members": (_address, [_size]),
    "live_set_member": (
        None,
        [_address, _size, _address, ctypes.c_uint8, _size, _address, ctypes.c_bool, _size, ctypes.c_bool],
    ),
    "live_introspection": (_address, [_address, _address, _address, _address, ctypes.c_uint32, _address]),
    "live_service_support": (
        _address,
        [_address, _address, _address, _address, _address, _address, _object, _address],
    ),
    "live_action_support": (_address, [_address] * 6),
}


def load_helper(path: Path | None = None) -> ctypes.PyDLL:
    """Load the helper, ready for use."""
    if problem := middleware.explain_middleware():
        raise NativeHelperError(problem)
    try:
        # PyDLL keeps the interpreter's lock during calls: the helper's table of types has no lock.
        helper = ctypes.PyDLL(str(path or LIBRARY))
        for name, (result, arguments) in _SIGNATURES.items():
            function = getattr(helper, name)
            function.restype, function.argtypes = result, arguments
    except (OSError, AttributeError) as error:
        raise NativeHelperError(
            f"The native helper of the course's interfaces could not be loaded ({error}). It is compiled when the "
            "course is installed: install it again (delete the folder .venv and run ./course lab, or "
            "pip install --force-reinstall --no-deps the course)."
        ) from error
    _refuse_another_source(helper)
    helper.live_setup(ctypes.byref(_imports()))
    return helper


def ros_library(name: str) -> ctypes.CDLL:
    """Open one of ROS's own libraries."""
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise NativeHelperError(
            f"The library {name} of ROS 2 Jazzy was not found ({error}). Messages defined at run time need ROS 2 with "
            "Fast DDS: install the course's ROS packages, or source your ROS 2 Jazzy, and start Python again."
        ) from error


def _refuse_another_source(helper: ctypes.PyDLL) -> None:
    """Refuse a helper that was compiled from other sources: it would take this one's messages for broken ones."""
    try:
        wanted = zlib.crc32(LEAVING.read_bytes(), zlib.crc32(SOURCE.read_bytes()))
    except OSError:  # packed without it, and so with what was compiled from it
        return
    source = getattr(helper, "live_source", None)  # the first helpers did not tell
    if source is None or source() & 0xFFFFFFFF != wanted:
        raise NativeHelperError(
            "The native helper of the course's interfaces was compiled from another version of the course. Run "
            "./course lab in the course's folder, which compiles it anew (if that changes nothing, delete the folder "
            ".venv and run it again), or pip install --force-reinstall --no-deps the course; then start Python again."
        )


def _imports() -> Imports:
    fastcdr = ros_library("libfastcdr.so.2")
    try:
        functions = [function_address(fastcdr[name]) for name in (_POSITION, _JUMP)]
        offsets = _probe_layout(fastcdr)
    except AttributeError as error:
        raise NativeHelperError(_unknown_fastcdr(str(error))) from error
    python = [function_address(getattr(ctypes.pythonapi, name)) for name in _PYTHON_FUNCTIONS]
    set_error = function_address(ros_library("librcutils.so").rcutils_set_error_state)
    release = sys.intern("release")  # a method's name
    keep_object(release)
    objects = [id(thing) for thing in (None, release, list, bytes, True, False)]
    return Imports(*functions, *offsets, set_error, *objects, *_probe_python(), *python)


def _probe_python() -> tuple[int, int]:
    """Where a list keeps the address of its items, and bytes keep theirs; zeros for a Python that differs."""
    items, octet = [object()], b"Z"
    in_list, in_bytes = 24, bytes.__basicsize__ - 1  # behind the reference count, the class and the size
    address = ctypes.c_void_p.from_address(id(items) + in_list).value
    sizes = [ctypes.c_ssize_t.from_address(id(item) + 16).value for item in (items, octet)]
    classes = [ctypes.c_void_p.from_address(id(item) + 8).value for item in (items, octet)]
    if sys.implementation.name != "cpython" or sizes != [1, 1] or classes != [id(list), id(bytes)] or not address:
        return 0, 0
    as_known = ctypes.c_void_p.from_address(address).value == id(items[0])
    as_known = as_known and ctypes.string_at(id(octet) + in_bytes, 1) == octet
    return (in_list, in_bytes) if as_known else (0, 0)


def _probe_layout(fastcdr: ctypes.CDLL) -> tuple[int, int, int]:
    """Find where a Cdr keeps its FastBuffer, and that its memory and size, by looking at a live pair of them."""
    length = 72
    memory = ctypes.create_string_buffer(length)
    buffer, cdr = ctypes.create_string_buffer(256), ctypes.create_string_buffer(2048)
    new_buffer, new_cdr, position = fastcdr[_NEW_BUFFER], fastcdr[_NEW_CDR], fastcdr[_POSITION]
    new_buffer.restype, new_buffer.argtypes = None, [_address, _address, _size]
    new_cdr.restype, new_cdr.argtypes = None, [_address, _address, ctypes.c_uint8, ctypes.c_uint8]
    position.restype, position.argtypes = _address, [_address]
    new_buffer(buffer, memory, length)
    new_cdr(cdr, buffer, _LITTLE_ENDIAN, _XCDR_V1)
    in_cdr, in_buffer = struct.unpack("256Q", cdr.raw), struct.unpack("32Q", buffer.raw)
    sought = [(in_cdr, ctypes.addressof(buffer)), (in_buffer, ctypes.addressof(memory)), (in_buffer, length)]
    if any(words.count(value) != 1 for words, value in sought) or position(cdr) != ctypes.addressof(memory):
        raise NativeHelperError(_unknown_fastcdr("its objects are laid out differently"))
    buffer_in_cdr, data_in_buffer, size_in_buffer = (8 * words.index(value) for words, value in sought)
    return buffer_in_cdr, data_in_buffer, size_in_buffer


def function_address(function: Any) -> int:  # the class of such a function has a private name
    """Where a function of a loaded library lies."""
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _unknown_fastcdr(detail: str) -> str:
    return (
        f"This Fast CDR is not the one of ROS 2 Jazzy ({detail}), so messages defined at run time cannot be used with "
        "it. Install the ROS packages in the versions the course names, or a ROS 2 Jazzy."
    )
