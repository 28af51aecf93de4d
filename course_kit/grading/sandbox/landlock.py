"""An allow-list of files kept by the kernel without any privilege (landlock(7), Linux 5.13 and later).

The second best to its own file system, for machines where namespaces are refused: names outside of the list can be
seen to exist, and neither opened nor changed. Newer kernels also keep signals, abstract sockets and TCP inside.
"""

from __future__ import annotations

import ctypes
import os
import stat
import struct
from contextlib import suppress
from typing import TYPE_CHECKING

from course_kit.grading.sandbox import namespaces
from course_kit.process import libc

if TYPE_CHECKING:
    from collections.abc import Iterable

_SYS_CREATE, _SYS_ADD, _SYS_RESTRICT = 444, 445, 446  # the same on every architecture
_VERSION = 1  # flag of landlock_create_ruleset
_PATH_BENEATH = 1

_EXECUTE, _WRITE_FILE, _READ_FILE, _READ_DIR = 0x1, 0x2, 0x4, 0x8
_FIRST_RIGHTS = (1 << 13) - 1
_REFER, _TRUNCATE, _IOCTL_DEV = 1 << 13, 1 << 14, 1 << 15  # since versions 2, 3 and 5
_OF_FILES = _EXECUTE | _WRITE_FILE | _READ_FILE | _TRUNCATE | _IOCTL_DEV
_BY_TCP = 0x3  # bind and connect, since version 4
_OUTSIDE = 0x3  # abstract sockets and signals, since version 6
_REFER_SINCE, _TRUNCATE_SINCE, _TCP_SINCE, _IOCTL_SINCE, _OUTSIDE_SINCE = 2, 3, 4, 5, 6


def version() -> int:
    """The kernel's version of Landlock, 0 where it has none or it is switched off."""
    try:
        return _make_rules(None, 0, _VERSION)
    except OSError:
        return 0


def restrict(readable: Iterable[tuple[str, bool]], writable: Iterable[str]) -> None:
    """Have this process, and all it will start, open nothing but what is listed, none of it a symbolic link.

    Args:
        readable: files, and folders with all below them, to read and to run; and whether of a folder no more than the
            names in it, and in the folders below it, may be read.
        writable: files and folders to do everything with.
    """
    kernel = version()
    rights = _FIRST_RIGHTS
    for since, right in ((_REFER_SINCE, _REFER), (_TRUNCATE_SINCE, _TRUNCATE), (_IOCTL_SINCE, _IOCTL_DEV)):
        rights |= right if kernel >= since else 0
    attributes = struct.pack(
        "=QQQ", rights, _BY_TCP if kernel >= _TCP_SINCE else 0, _OUTSIDE if kernel >= _OUTSIDE_SINCE else 0
    )
    size = 24 if kernel >= _OUTSIDE_SINCE else 16 if kernel >= _TCP_SINCE else 8
    rules = _make_rules(attributes, size)
    try:
        for path, only_names in readable:
            _allow(rules, path, _READ_DIR if only_names else _EXECUTE | _READ_FILE | _READ_DIR)
        for path in writable:
            _allow(rules, path, rights)
        namespaces.forbid_new_privileges()
        libc.system_call(_SYS_RESTRICT, rules, ctypes.c_uint(0), what="landlock_restrict_self")
    finally:
        os.close(rules)


def _make_rules(attributes: bytes | None, size: int, flags: int = 0) -> int:
    arguments = (attributes, ctypes.c_size_t(size), ctypes.c_uint(flags))
    return libc.system_call(_SYS_CREATE, *arguments, what="landlock_create_ruleset")


def _allow(rules: int, path: str, rights: int) -> None:
    with suppress(FileNotFoundError, PermissionError, NotADirectoryError):  # what cannot be opened needs no rule
        # A link would give its rights to what it leads to.
        opened = os.open(path, os.O_PATH | os.O_CLOEXEC | os.O_NOFOLLOW)
        try:
            if not stat.S_ISDIR(os.fstat(opened).st_mode):
                rights &= _OF_FILES
            rule = struct.pack("=Qi", rights, opened)
            arguments = (rules, ctypes.c_int(_PATH_BENEATH), rule, ctypes.c_uint(0))
            libc.system_call(_SYS_ADD, *arguments, what=f"landlock_add_rule {path}")
        finally:
            os.close(opened)
