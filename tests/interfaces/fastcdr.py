"""Drives the serializers of compiled types directly, to get payloads in encodings rmw_fastrtps does not write."""

from __future__ import annotations

import ctypes
from typing import Any

from course_kit.interfaces.native.loader import function_address, ros_library
from course_kit.interfaces.native.memory import pointer
from tests.interfaces.twins import read_words, type_support

_ADDRESS, _SIZE, _BYTE = ctypes.c_void_p, ctypes.c_size_t, ctypes.c_uint8
_CDR = "_ZN8eprosima7fastcdr3Cdr"
# Byte order, version and flag of Fast CDR for the encodings of plain types.
ENCODINGS = {
    "XCDR1 big": (0, 2, 0),
    "XCDR1 little": (1, 2, 0),
    "XCDR2 big": (0, 3, 6),
    "XCDR2 little": (1, 3, 6),
}
_BUFFER_SIZE = 1 << 20


def _function(library: ctypes.CDLL, name: str, result: Any, *arguments: Any) -> Any:
    return ctypes.CFUNCTYPE(result, *arguments)(function_address(library[name]))


class Writer:
    """Serializes compiled messages with Fast CDR set to any encoding."""

    def __init__(self) -> None:
        library = ros_library("libfastcdr.so.2")
        self._new_buffer = _function(library, "_ZN8eprosima7fastcdr10FastBufferC1EPcm", None, _ADDRESS, _ADDRESS, _SIZE)
        self._new_cdr = _function(
            library,
            f"{_CDR}C1ERNS0_10FastBufferENS1_10EndiannessENS0_10CdrVersionE",
            None,
            _ADDRESS,
            _ADDRESS,
            _BYTE,
            _BYTE,
        )
        flag_name = f"{_CDR}17set_encoding_flagENS0_21EncodingAlgorithmFlagE"
        self._set_flag = _function(library, flag_name, ctypes.c_bool, _ADDRESS, _BYTE)
        self._header = _function(library, f"{_CDR}23serialize_encapsulationEv", _ADDRESS, _ADDRESS)
        self._length = _function(library, "_ZNK8eprosima7fastcdr3Cdr26get_serialized_data_lengthEv", _SIZE, _ADDRESS)
        handle = "get_message_typesupport_handle"
        self._handle = _function(ros_library("librosidl_runtime_c.so"), handle, _ADDRESS, _ADDRESS, ctypes.c_char_p)
        self._memory = ctypes.create_string_buffer(_BUFFER_SIZE)
        self._buffer, self._cdr = ctypes.create_string_buffer(256), ctypes.create_string_buffer(2048)

    def payload(self, message: Any, encoding: str) -> bytes:
        """The message in one of ENCODINGS, header included."""
        metaclass: Any = type(type(message))
        fastrtps = self._handle(type_support(type(message)), b"rosidl_typesupport_fastrtps_c")
        callbacks = read_words(fastrtps + 8)[0]
        serialize = ctypes.PYFUNCTYPE(ctypes.c_bool, _ADDRESS, _ADDRESS)(read_words(callbacks + 16)[0])
        create = ctypes.PYFUNCTYPE(_ADDRESS)(pointer(metaclass._CREATE_ROS_MESSAGE))
        destroy = ctypes.PYFUNCTYPE(None, _ADDRESS)(pointer(metaclass._DESTROY_ROS_MESSAGE))
        from_python = ctypes.PYFUNCTYPE(ctypes.c_bool, ctypes.py_object, _ADDRESS)(pointer(metaclass._CONVERT_FROM_PY))
        byte_order, version, flag = ENCODINGS[encoding]
        cdr, made = ctypes.addressof(self._cdr), create()
        self._new_buffer(ctypes.addressof(self._buffer), ctypes.addressof(self._memory), _BUFFER_SIZE)
        self._new_cdr(cdr, ctypes.addressof(self._buffer), byte_order, version)
        assert from_python(message, made)
        assert self._set_flag(cdr, flag)
        self._header(cdr)
        assert serialize(made, cdr)
        destroy(made)
        return self._memory.raw[: self._length(cdr)]
