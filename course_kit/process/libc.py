"""What Python has no function for, by the C library; what fails raises OSError, as Python's own functions do."""

from __future__ import annotations

import ctypes
import errno
import os
import signal

_PR_SET_PDEATHSIG, _PR_SET_NAME, _PR_SET_CHILD_SUBREAPER = 1, 15, 36
_libc = ctypes.CDLL(None, use_errno=True)


def call_libc(function: str, *arguments: object, what: str = "") -> int:
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
    return call_libc("syscall", ctypes.c_long(number), *arguments, what=what)


def call_prctl(option: int, *arguments: object, what: str) -> int:
    """Change how the kernel treats this process (prctl(2)); arguments that are not given are 0, otherwise as `call`."""
    return call_libc("prctl", option, *arguments, *(0,) * (4 - len(arguments)), what=f"prctl {what}")


def die_with_parent(parent: int = 0, number: signal.Signals = signal.SIGKILL) -> None:
    """Have the kernel end this process when its parent ends; lost with a new user, or namespace of users."""
    call_prctl(_PR_SET_PDEATHSIG, number, what="PDEATHSIG")
    if parent and os.getppid() != parent:
        os.kill(os.getpid(), number)


def adopt_orphans() -> None:
    """Become the parent of every descendant whose own parent ends (PR_SET_CHILD_SUBREAPER)."""
    call_prctl(_PR_SET_CHILD_SUBREAPER, 1, what="CHILD_SUBREAPER")


def set_name(name: str) -> None:
    """Have `ps` and `top` show this process under a name of at most 15 characters."""
    call_prctl(_PR_SET_NAME, name.encode(), what="NAME")


def make_memory_file(name: str) -> int:
    """A descriptor of a file in memory (memfd_create(2)), also for a Python that was built for an older C library."""
    return call_libc("memfd_create", name.encode(), 1)  # MFD_CLOEXEC
