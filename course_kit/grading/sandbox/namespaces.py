"""Linux namespaces by system call, for processes without any privilege (namespaces(7), user_namespaces(7)).

Each function works on the calling process, which must have one thread only; OSError where the machine refuses.
"""

from __future__ import annotations

import errno
import fcntl
import os
import socket
import struct
from contextlib import suppress
from pathlib import Path

from course_kit.grading.sandbox import machine
from course_kit.process import libc

CLONE_NEWNS = 0x00020000
CLONE_NEWUTS = 0x04000000
CLONE_NEWIPC = 0x08000000
CLONE_NEWUSER = 0x10000000
CLONE_NEWPID = 0x20000000
CLONE_NEWNET = 0x40000000

_SIOCSIFFLAGS, _IFF_UP = 0x8914, 0x1

_PR_GET_DUMPABLE, _PR_SET_DUMPABLE, _PR_SET_NO_NEW_PRIVS = 3, 4, 38
_CAPABILITY_VERSION_3 = 0x20080522
_SHELL = "/bin/sh"
# Each map in one go, as the kernel wants it. Arguments: the process, its map of users, its map of groups.
_MAP_WHEN_TOLD = 'read -r _ && printf %s "$2" >"/proc/$1/uid_map" && printf %s "$3" >"/proc/$1/gid_map"'


def enter(kinds: int, guest: int = 0) -> None:
    """Move into a new user namespace and, in it, the new namespaces `kinds` (CLONE_NEW... or-ed)."""
    before = libc.call_prctl(_PR_GET_DUMPABLE, what="DUMPABLE")
    allow_tracing()  # else /proc/self does not belong to this process's user
    try:
        if guest:
            _unshare_with_guest(kinds, guest)
            return
        user, group = os.geteuid(), os.getegid()
        libc.call_libc("unshare", CLONE_NEWUSER | kinds)
        Path("/proc/self/setgroups").write_bytes(b"deny")
        Path("/proc/self/uid_map").write_bytes(b"%d %d 1" % (user, user))
        Path("/proc/self/gid_map").write_bytes(b"%d %d 1" % (group, group))
    finally:
        libc.call_prctl(_PR_SET_DUMPABLE, int(before == 1), what="DUMPABLE")  # 2 is what only the kernel may set


def _unshare_with_guest(kinds: int, guest: int) -> None:
    """Only a process that stays outside may map more than one number; it has to be root there."""
    own = Path("/proc/self").readlink().name
    maps = [f"{number} {number} 1\n{guest} {guest} 1" for number in (os.geteuid(), os.getegid())]
    ready, tell = os.pipe()
    stdin = [(os.POSIX_SPAWN_DUP2, ready, 0)]
    helper = os.posix_spawn(_SHELL, [_SHELL, "-c", _MAP_WHEN_TOLD, _SHELL, own, *maps], {}, file_actions=stdin)
    os.close(ready)
    try:
        libc.call_libc("unshare", CLONE_NEWUSER | kinds)
        os.write(tell, b"now\n")
    finally:
        os.close(tell)
        _, status = os.waitpid(helper, 0)
    if status:
        raise OSError(errno.EPERM, "a second user cannot be mapped into the user namespace")


def join(user: int, network: int) -> None:
    """Move into the user and the network namespace of another process of the same user (setns(2))."""
    for descriptor, kind in ((user, CLONE_NEWUSER), (network, CLONE_NEWNET)):
        libc.call_libc("setns", descriptor, kind)


def enter_network(user: int = 0) -> None:
    """Put this process and its later children into their own network with nothing but loopback."""
    enter(CLONE_NEWNET, user)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:  # `lo` begins switched off; a struct ifreq
        fcntl.ioctl(control, _SIOCSIFFLAGS, struct.pack("16sH14x", b"lo", _IFF_UP))
    with suppress(OSError):  # then a socket of TCP may hold more than it counts with
        for name in ("tcp_rmem", "tcp_wmem"):
            Path("/proc/sys/net/ipv4", name).write_text(f"4096 65536 {machine.BUFFER}", encoding="ascii")


def enter_processes(user: int = 0) -> None:
    """Give the later children of this process separate PIDs, mounts, host name and System V memory."""
    enter(CLONE_NEWPID | CLONE_NEWNS | CLONE_NEWIPC | CLONE_NEWUTS, user)


def become(user: int) -> None:
    """Turn this process, which is root, into one of a user without rights."""
    os.setgroups([])
    os.setresgid(user, user, user)
    os.setresuid(user, user, user)


def forbid_tracing() -> None:
    """Let no process of the same user read this one's memory or trace it (ptrace(2))."""
    libc.call_prctl(_PR_SET_DUMPABLE, 0, what="DUMPABLE")


def allow_tracing() -> None:
    """Take `forbid_tracing` back; a change of the user forbids it as well."""
    libc.call_prctl(_PR_SET_DUMPABLE, 1, what="DUMPABLE")


def forbid_new_privileges() -> None:
    """Let no program that this process starts have more rights than itself, set-uid ones included."""
    libc.call_prctl(_PR_SET_NO_NEW_PRIVS, 1, what="NO_NEW_PRIVS")


def drop_privileges() -> None:
    """Give up every capability for good, and the chance to gain one by running a set-uid program."""
    forbid_new_privileges()
    libc.call_libc("capset", struct.pack("Ii", _CAPABILITY_VERSION_3, 0), bytes(24))
