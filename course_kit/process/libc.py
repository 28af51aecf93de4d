"""Functions of the C library for what Python has no function for; one that fails raises OSError, as Python's own do."""

from __future__ import annotations

import ctypes
import errno
import os

_libc = ctypes.CDLL(None, use_errno=True)


def call(function: str, *arguments: object, what: str = "") -> int:
    """Call a function that answers with a negative number where it fails."""
    try:
        found = getattr(_libc, function)
    except AttributeError:  # no Linux
        raise OSError(errno.ENOSYS, f"{what or function}: {os.strerror(errno.ENOSYS)}") from None
    result = int(found(*arguments))
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{what or function}: {os.strerror(number)}")
    return result


def system_call(number: int, *arguments: object, what: str) -> int:
    """Make a system call that the C library has no function for (syscall(2)); otherwise as `call`."""
    return call("syscall", ctypes.c_long(number), *arguments, what=what)


def prctl(option: int, *arguments: object, what: str) -> int:
    """Change how the kernel treats this process (prctl(2)); arguments that are not given are 0, otherwise as `call`."""
    return call("prctl", option, *arguments, *(0,) * (4 - len(arguments)), what=f"prctl {what}")
