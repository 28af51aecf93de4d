"""System calls that a submission does without (seccomp(2)): the kernel answers them with "not permitted".

They would lead out of the sandbox (other processes' memory and descriptors, namespaces, mounts, keyrings, the
terminal's input), make others wait for a file or watch what they do with it (leases, notices), or take memory that
nothing counts (shared memory that no file backs, pages that lie in a pipe, large buffers of sockets).
"""

from __future__ import annotations

import ctypes
import errno
import os
import struct
from typing import TYPE_CHECKING

from course_kit.grading.sandbox import namespaces
from course_kit.process import libc

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_PR_SET_SECCOMP, _MODE_FILTER = 22, 2

# Offsets in struct seccomp_data.
_NUMBER, _ARCHITECTURE, _FIRST_ARGUMENT, _SECOND_ARGUMENT, _THIRD_ARGUMENT, _FOURTH_ARGUMENT = 0, 4, 16, 24, 32, 40
_PRIO_USER = 2
# BPF: load a word, compare, test bits, keep some bits, return.
_LOAD, _EQUAL, _BITS, _AT_LEAST, _AND, _RETURN = 0x20, 0x15, 0x45, 0x35, 0x54, 0x06
_ALLOW, _ERRNO = 0x7FFF0000, 0x00050000
_DONE = _ERRNO  # without doing it: error 0 is none

_NAMESPACE_FLAGS = 0x7E020080  # CLONE_NEW..., time namespaces included
_TIOCSTI, _TIOCLINUX = 0x5412, 0x541C  # type into a terminal
# FS_IOC_SETFLAGS with its 32-bit form, and FS_IOC_FSSETXATTR: flags of a file that only root can take off
_FILE_FLAGS = (0x40086602, 0x40046602, 0x401C5820)
_LEASE, _NOTICES = 1024, 1026  # F_SETLEASE lets everybody else who opens a file wait; F_NOTIFY
_SHARED_ANONYMOUS = 0x21  # of mmap: its pages stay, uncounted, when a program gives them back
# What can be counted: AF_UNIX, AF_INET, AF_INET6 and AF_NETLINK, with none of the protocols that come after IDP.
_FAMILIES = (1, 2, 10, 16)
_PROTOCOLS = 23
_SOL_SOCKET, _BUFFER_SIZES = 1, (7, 8)  # SO_SNDBUF, SO_RCVBUF: the kernel cuts down such a wish, too
_X32 = 0x40000000  # system calls of the x32 interface of x86-64

_AUDIT = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
_CLONE = {"x86_64": 56, "aarch64": 220}
_IOCTL = {"x86_64": 16, "aarch64": 29}
_FCNTL = {"x86_64": 72, "aarch64": 25}
_MMAP = {"x86_64": 9, "aarch64": 222}
_SOCKET = {"x86_64": 41, "aarch64": 198}
_SOCKETPAIR = {"x86_64": 53, "aarch64": 199}
_SETSOCKOPT = {"x86_64": 54, "aarch64": 208}
_CLONE3 = 435  # its flags lie in memory where no filter can look; the C library falls back to clone

# The number on x86-64, and that on AArch64. What only root may do is not among them: a submission has no capability.
_REFUSED = {
    "ptrace": (101, 117),
    "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271),
    "kcmp": (312, 272),
    "unshare": (272, 97),
    "setns": (308, 268),
    "mount": (165, 40),
    "add_key": (248, 217),
    "request_key": (249, 218),
    "keyctl": (250, 219),
    "memfd_create": (319, 279),
    "vmsplice": (278, 75),
    "shmget": (29, 194),
    "semget": (64, 190),
    "msgget": (68, 186),
    "mq_open": (240, 180),
    "bpf": (321, 280),
    "perf_event_open": (298, 241),
    "userfaultfd": (323, 282),
    "fanotify_init": (300, 262),
    "inotify_add_watch": (254, 27),
    "pidfd_getfd": (438, 438),
    "process_madvise": (440, 440),
    "io_uring_setup": (425, 425),
    "io_uring_enter": (426, 426),
    "io_uring_register": (427, 427),
    "memfd_secret": (447, 447),
    "file_setattr": (469, 469),
}

# Where there is no PID namespace the kernel asks only whose the other process is. No filter sees whether a thread is
# the program's own, which Fast DDS wants to set: so these are answered as done. By the argument that names it:
_OF_PROCESSES = {
    "x86_64": {_FIRST_ARGUMENT: (203, 144, 142, 314, 256), _SECOND_ARGUMENT: (141, 251)},
    "aarch64": {_FIRST_ARGUMENT: (122, 119, 118, 274, 238), _SECOND_ARGUMENT: (140, 30)},
}  # sched_set{affinity, scheduler, param, attr}, migrate_pages; setpriority, ioprio_set
_LIMITS = {"x86_64": 302, "aarch64": 261}  # prlimit64: it could stop even the init process of a PID namespace
# Without a separate file system: Landlock does not ask about these. They are answered as done and change
# nothing: no filter sees which file is meant, and programs copy their files with mode and times.
_OF_FILES = {
    "x86_64": (90, 91, 268, 452, 92, 93, 94, 260, 132, 235, 261, 280, 188, 189, 190, 197, 198, 199, 463, 466),
    "aarch64": (52, 53, 452, 54, 55, 88, 5, 6, 7, 14, 15, 16, 463, 466),
}  # ch{mod, own} and utime with their relatives, {set, remove}xattr with theirs


class _Program(ctypes.Structure):
    """struct sock_fprog."""

    _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_char_p))


def install(*, processes: bool = True, files: bool = True) -> None:
    """Put the filter on this process and all it will start."""
    machine = os.uname().machine
    if machine not in _AUDIT:
        raise OSError(errno.ENOSYS, f"there is no list of system calls for {machine}")
    code = b"".join(_filter(machine, processes=processes, files=files))
    program = _Program(len(code) // 8, code)
    namespaces.forbid_new_privileges()
    libc.call_prctl(_PR_SET_SECCOMP, _MODE_FILTER, ctypes.byref(program), what="SECCOMP")


def _filter(machine: str, *, processes: bool, files: bool) -> Iterator[bytes]:
    """The instructions, eight bytes each. Every test that hits returns at once; what passes all is allowed."""
    refuse, unknown = _ERRNO | errno.EPERM, _ERRNO | errno.ENOSYS
    yield _load(_ARCHITECTURE)
    yield _instruction(_EQUAL, _AUDIT[machine], 1, 0)
    yield _return(unknown)  # the 32-bit interface has other numbers
    yield _load(_NUMBER)
    yield from _test_value(_AT_LEAST, _X32, unknown)
    yield from _test_value(_EQUAL, _CLONE3, unknown)
    yield from _test_any(() if files else _OF_FILES[machine], _DONE)
    yield from _test_any(list(zip(*_REFUSED.values(), strict=True))[tuple(_AUDIT).index(machine)], refuse)
    for number, tests in _by_arguments(machine, processes):
        yield _instruction(_EQUAL, number, 0, len(tests) + 1)
        yield from tests
        yield _load(_NUMBER)
    yield _return(_ALLOW)


def _by_arguments(machine: str, processes: bool) -> Iterator[tuple[int, list[bytes]]]:
    """System calls that are refused for some arguments: the number, and the instructions that find these."""
    refuse = _ERRNO | errno.EPERM
    of_another = [_load(_FIRST_ARGUMENT), _instruction(_EQUAL, 0, 1, 0)]
    yield _LIMITS[machine], [*of_another, _return(refuse)]
    calls = {_FIRST_ARGUMENT: (), _SECOND_ARGUMENT: ()} if processes else _OF_PROCESSES[machine]
    for number in calls[_FIRST_ARGUMENT]:
        yield number, [*of_another, _return(_DONE)]
    # The first argument says what kind of number the second one is, PRIO_USER for a user's.
    of_user = [_load(_FIRST_ARGUMENT), _instruction(_AT_LEAST, _PRIO_USER, 2, 0)]
    for number in calls[_SECOND_ARGUMENT]:
        yield number, [*of_user, _load(_SECOND_ARGUMENT), _instruction(_EQUAL, 0, 1, 0), _return(_DONE)]
    yield _CLONE[machine], [_load(_FIRST_ARGUMENT), *_test_value(_BITS, _NAMESPACE_FLAGS, refuse)]
    yield _IOCTL[machine], [_load(_SECOND_ARGUMENT), *_test_any((_TIOCSTI, _TIOCLINUX, *_FILE_FLAGS), refuse)]
    yield _FCNTL[machine], [_load(_SECOND_ARGUMENT), *_test_any((_LEASE, _NOTICES), refuse)]
    shared = [_instruction(_AND, _SHARED_ANONYMOUS), *_test_value(_EQUAL, _SHARED_ANONYMOUS, refuse)]
    yield _MMAP[machine], [_load(_FOURTH_ARGUMENT), *shared]
    sizes = [_load(_THIRD_ARGUMENT), *_test_any(_BUFFER_SIZES, _DONE)]
    yield _SETSOCKOPT[machine], [_load(_SECOND_ARGUMENT), _instruction(_EQUAL, _SOL_SOCKET, 0, len(sizes)), *sizes]
    families = [_instruction(_EQUAL, family, len(_FAMILIES) - at) for at, family in enumerate(_FAMILIES)]
    families = [_load(_FIRST_ARGUMENT), *families, _return(_ERRNO | errno.EAFNOSUPPORT)]
    protocols = [_load(_THIRD_ARGUMENT), *_test_value(_AT_LEAST, _PROTOCOLS, _ERRNO | errno.EPROTONOSUPPORT)]
    for call in (_SOCKET[machine], _SOCKETPAIR[machine]):
        yield call, [*families, *protocols]


def _test_any(values: Iterable[int], result: int) -> Iterator[bytes]:
    for value in values:
        yield from _test_value(_EQUAL, value, result)


def _test_value(test: int, value: int, result: int) -> Iterator[bytes]:
    yield _instruction(test, value, 0, 1)
    yield _return(result)


def _load(offset: int) -> bytes:
    return _instruction(_LOAD, offset)


def _return(value: int) -> bytes:
    return _instruction(_RETURN, value)


def _instruction(code: int, value: int, if_true: int = 0, if_false: int = 0) -> bytes:
    return struct.pack("=HBBI", code, if_true, if_false, value)
