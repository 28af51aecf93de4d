"""Mounts by system call (mount(2), mount_setattr(2), pivot_root(2)), within our own mount namespace.

Each function raises OSError when the machine does not allow it.
"""

from __future__ import annotations

import ctypes
import os
import struct

from course_kit.process import libc

_MS_NOSUID, _MS_NODEV, _MS_NOEXEC = 0x2, 0x4, 0x8
_MS_BIND, _MS_REC, _MS_PRIVATE = 0x1000, 0x4000, 0x40000
_MNT_DETACH = 2
_SYS_MOUNT_SETATTR = 442  # the same number on every architecture, Linux 5.12 and later
_SYS_PIVOT_ROOT = {"x86_64": 155, "aarch64": 41}
_AT_FDCWD, _AT_RECURSIVE = -100, 0x8000
_ATTR_RDONLY, _ATTR_NOSUID, _ATTR_NODEV = 0x1, 0x2, 0x4


def _mount(source: str, target: str, kind: str, flags: int, options: str = "") -> None:
    arguments = [os.fsencode(text) or None for text in (source, target, kind)]
    data = os.fsencode(options) or None
    libc.call_libc("mount", *arguments, ctypes.c_ulong(flags), data, what=f"mount {kind or source} on {target}")


def detach() -> None:
    """Keep what is mounted from now on out of the sight of every other process."""
    _mount("", "/", "", _MS_REC | _MS_PRIVATE)


def bind(source: str, target: str) -> None:
    """Show a file or folder, with all that is mounted in it, at a second place."""
    _mount(source, target, "", _MS_BIND | _MS_REC)


def memory(target: str, megabytes: int, *, mode: int = 0o755, user: int = 0) -> None:
    """Mount an empty file system in memory, gone with the last process that sees it."""
    owner = f",uid={user},gid={user}" if user else ""
    options = f"size={megabytes}m,nr_inodes=4096,mode={mode:o}{owner}"
    _mount("tmpfs", target, "tmpfs", _MS_NOSUID | _MS_NODEV, options)


def processes(target: str) -> None:
    """Mount a /proc that shows the processes of this PID namespace only."""
    _mount("proc", target, "proc", _MS_NOSUID | _MS_NODEV | _MS_NOEXEC)


def make_read_only(folder: str, *, devices: bool = False) -> None:
    """Make all that is mounted at a folder and below it read-only and its set-uid programs ordinary ones."""
    attributes = _ATTR_RDONLY | _ATTR_NOSUID | (0 if devices else _ATTR_NODEV)
    packed = struct.pack("QQQQ", attributes, 0, 0, 0)
    where = (ctypes.c_int(_AT_FDCWD), os.fsencode(folder), ctypes.c_uint(_AT_RECURSIVE))
    size = ctypes.c_size_t(len(packed))
    libc.system_call(_SYS_MOUNT_SETATTR, *where, packed, size, what=f"mount_setattr {folder}")


def change_root(folder: str) -> None:
    """Make a mount point the root of all file names; what was mounted before is out of reach from then on."""
    number = _SYS_PIVOT_ROOT[os.uname().machine]
    os.chdir(folder)
    # The old root comes to lie on top of the new one, from where it is taken away: no folder is needed for it.
    libc.system_call(number, b".", b".", what="pivot_root")
    libc.call_libc("umount2", b".", _MNT_DETACH, what="umount the old root")
    os.chdir("/")
