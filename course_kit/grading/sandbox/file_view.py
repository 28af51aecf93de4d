"""The files a submission sees: an allow-list, laid out as a separate root file system or kept by Landlock.

It sees Python with its libraries, ROS, the parts of this kit that a program may import, a few devices and its scratch
directory. There is no home, no checkout, no other submission, and nothing of the grader.

Landlock (landlock(7), Linux 5.13 and later) takes no privilege, and is the second best: names outside of the list can
be seen to exist, and neither opened nor changed. Newer kernels also keep signals, abstract sockets and TCP inside.
"""

from __future__ import annotations

import ctypes
import os
import stat
import struct
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.sandbox import namespaces
from course_kit.process import libc

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

_PACKAGE = Path(__file__).resolve().parents[2]
ROBOT = str(_PACKAGE / "robot.py")  # the one module that exercises ask a submission to import
# What a submission, and a Python that it starts, may import of the kit; the rest does not exist for it.
MODULES_OF_KIT = ("autoload", "robot", "environment", "interfaces", "launch")
_PARTS_OF_KIT = ("__init__.py", "py.typed", *MODULES_OF_KIT, *(f"{name}.py" for name in MODULES_OF_KIT))
_SYSTEM = (
    *("/usr", "/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32", "/nix/store"),
    *("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/alternatives"),
    *("/etc/localtime", "/etc/timezone", "/etc/mime.types"),
    *("/etc/ssl/certs", "/etc/ssl/openssl.cnf"),  # and not ssl/private, which holds the machine's keys
)
_SEARCH_PATHS = ("LD_LIBRARY_PATH", "AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH", "COURSE_KIT_INTERFACE_PATH")
_DEVICES = ("null", "random", "urandom")  # not "zero": shared, it is memory that nothing counts
_DEVICE_LINKS = {"fd": "/proc/self/fd", "stdin": "fd/0", "stdout": "fd/1", "stderr": "fd/2"}
_ACCOUNTS = {
    "passwd": "root:x:0:0::/:/bin/sh\nlearner:x:{user}:{group}::{home}:/bin/sh\n",
    "group": "root:x:0:\nlearner:x:{group}:\n",
    "hosts": "127.0.0.1 localhost\n::1 localhost\n",
    "nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
}
_MOST_LINKS = 40  # that Linux follows, too
# Of mount(2), mount_setattr(2) and pivot_root(2).
_MS_NOSUID, _MS_NODEV, _MS_NOEXEC = 0x2, 0x4, 0x8
_MS_BIND, _MS_REC, _MS_PRIVATE = 0x1000, 0x4000, 0x40000
_MNT_DETACH = 2
_SYS_MOUNT_SETATTR = 442  # the same number on every architecture, Linux 5.12 and later
_SYS_PIVOT_ROOT = {"x86_64": 155, "aarch64": 41}
_AT_FDCWD, _AT_RECURSIVE = -100, 0x8000
_ATTR_RDONLY, _ATTR_NOSUID, _ATTR_NODEV = 0x1, 0x2, 0x4
# Of Landlock. The system calls have the same numbers on every architecture.
_SYS_CREATE, _SYS_ADD, _SYS_RESTRICT = 444, 445, 446
_VERSION, _PATH_BENEATH = 1, 1  # flag of landlock_create_ruleset; a kind of rule
_EXECUTE, _WRITE_FILE, _READ_FILE, _READ_DIR = 0x1, 0x2, 0x4, 0x8
_FIRST_RIGHTS = (1 << 13) - 1
_REFER, _TRUNCATE, _IOCTL_DEV = 1 << 13, 1 << 14, 1 << 15
_LATER_RIGHTS = ((2, _REFER), (3, _TRUNCATE), (5, _IOCTL_DEV))  # by the version that knows them
_OF_FILES = _EXECUTE | _WRITE_FILE | _READ_FILE | _TRUNCATE | _IOCTL_DEV
_BY_TCP, _TCP_SINCE = 0x3, 4  # bind and connect
_OUTSIDE, _OUTSIDE_SINCE = 0x3, 6  # abstract sockets and signals
_ROOT_MB = 1  # of the root itself, which holds nothing but folders and the files above


@dataclass(frozen=True)
class FileView:
    """What is seen."""

    shown: tuple[str, ...] = ()  # files and folders, read-only
    masked: tuple[str, ...] = ()  # files and folders within these that look empty but for what of `shown` lies in them
    links: tuple[str, ...] = ()  # those on the way to what is shown, for whoever looks for it by another name

    def with_more(self, shown: Iterable[str] = (), masked: Iterable[str] = ()) -> FileView:
        """The same view and more, by whatever names."""
        named = list(shown)
        real = list(map(os.path.realpath, named))
        links = (link for name, other in zip(named, real, strict=True) if name != other for link in _links(name))
        return FileView(
            tuple(dict.fromkeys((*self.shown, *real))),
            tuple(dict.fromkeys((*self.masked, *map(os.path.realpath, masked)))),
            tuple(dict.fromkeys((*self.links, *links))),
        )


def find_view(command: Sequence[str] = (), folder: str = "") -> FileView:
    """What a Python program needs on this machine; a user's own command also its folder, PATH, and what it names."""
    named = named_paths(command, folder)
    wanted = {folder, *named} if command else set()
    places = [*_entries(os.environ.get("PATH", "")), *map(os.path.dirname, named)] if command else []
    safe = {path for path in (*_interpreter(), *places) if _is_safe(path)} | wanted
    is_shown = set(_checkout()) & set(map(os.path.realpath, safe))
    masked = () if is_shown else (str(_PACKAGE), *_checkout(), os.path.expanduser("~"))  # noqa: PTH111
    kit = [str(_PACKAGE / part) for part in _PARTS_OF_KIT]
    return FileView().with_more(sorted({*_SYSTEM, *safe, *kit}), masked)


def named_paths(words: Iterable[str], folder: str) -> list[str]:
    """The files and folders that the words of a command name, each as it is named and as it really is."""
    found = [os.path.join(folder, word) for word in words if os.sep in word]  # noqa: PTH118 - as text, like the others
    return [path for name in found if os.path.exists(name) for path in (name, os.path.realpath(name))]  # noqa: PTH110


def _links(path: str) -> Iterator[str]:
    """The links that are followed on the way to a file, in this order."""
    for _ in range(_MOST_LINKS):
        link = next((parent for parent in (*reversed(Path(path).parents), Path(path)) if parent.is_symlink()), None)
        if link is None:
            return
        yield str(link)
        path = os.path.normpath(link.parent / link.readlink() / Path(path).relative_to(link))


def _checkout() -> tuple[str, ...]:
    """The course's folder, where the package lies in one and not among other libraries."""
    return (str(_PACKAGE.parent),) if (_PACKAGE.parent / "pyproject.toml").is_file() else ()


def _interpreter() -> list[str]:
    """Python, its libraries and ROS, each where it says it is."""
    searched = [os.environ.get(variable, "") for variable in _SEARCH_PATHS]
    files = os.path.realpath(sys.executable), *_loaded_libraries()
    named = [sys.prefix, sys.base_prefix, sys.exec_prefix, *map(os.path.dirname, files)]
    return named + _entries(os.pathsep.join((*sys.path, *searched)))


def _entries(text: str) -> list[str]:
    return [entry for entry in text.split(os.pathsep) if os.path.isabs(entry)]  # noqa: PTH117


def _loaded_libraries() -> set[str]:
    """The files of the libraries that are loaded."""
    with open("/proc/self/maps", encoding="utf-8", errors="surrogateescape") as file:  # noqa: PTH123 - a file of the kernel
        names = {line[line.index("/") :].rstrip("\n") for line in file if "/" in line}
    return {name for name in names if ".so" in name}


def _is_safe(path: str) -> bool:
    """Whether a folder that a variable names may be shown; one around a home, this kit or /tmp would show too much."""
    named = (*_checkout(), tempfile.gettempdir(), os.path.expanduser("~"))  # noqa: PTH111 - never fails
    real = Path(os.path.realpath(path))
    return str(real) != "/" and not any(Path(os.path.realpath(name)).is_relative_to(real) for name in named)


def lay_out(view: FileView, scratch: str, megabytes: int, user: int = 0) -> None:
    """Make the view the file system of this process, the first of its PID namespace, in a new mount namespace.

    Its root is made in the scratch directory, and has one in it by the same name.
    """
    with suppress(OSError):  # then only the filter of system calls keeps it from making user namespaces
        Path("/proc/sys/user/max_user_namespaces").write_text("0", encoding="ascii")
    root = scratch
    umask = os.umask(0o022)  # another user has to find the way
    detach_mounts()
    mount_memory(root, _ROOT_MB)
    for path, is_mask in _in_order(view):
        _mask(root, path) if is_mask else _show(root, path)
    for folder in ("/etc", "/proc", "/dev", "/dev/shm", "/tmp", scratch):  # noqa: S108 - of the new root
        os.makedirs(f"{root}{folder}", exist_ok=True)  # noqa: PTH103 - a name within another root
    for name, text in _ACCOUNTS.items():
        filled = text.format(user=user or os.getuid(), group=user or os.getgid(), home=scratch)
        Path(f"{root}/etc/{name}").write_text(filled, encoding="utf-8")
    for name in _DEVICES:
        Path(f"{root}/dev/{name}").touch()
    for name, target in _DEVICE_LINKS.items():
        os.symlink(target, f"{root}/dev/{name}")  # noqa: PTH211
    _make_read_only(root)
    for name in _DEVICES:
        with suppress(OSError):  # some containers have fewer
            bind(f"/dev/{name}", f"{root}/dev/{name}")
            _make_read_only(f"{root}/dev/{name}", devices=True)
    mount_memory(f"{root}/dev/shm", megabytes, mode=0o1777, user=user)  # noqa: S108 - of the new root
    mount_memory(f"{root}{scratch}", megabytes, mode=0o700, user=user)
    try:
        _mount("proc", f"{root}/proc", "proc", _MS_NOSUID | _MS_NODEV | _MS_NOEXEC)  # of this PID namespace only
    except OSError:  # refused in containers that mask parts of /proc: the old one shows more, and allows no more
        bind("/proc", f"{root}/proc")
    _make_read_only(f"{root}/proc")  # the kernel's settings ask who writes, and not what he is capable of
    _change_root(root)
    os.umask(umask)


def _in_order(view: FileView) -> list[tuple[str, bool]]:
    """Path, and whether it is a mask; each after the folders it lies in, without what is shown already."""
    kinds = dict.fromkeys(view.links, False) | dict.fromkeys(view.shown, False) | dict.fromkeys(view.masked, True)
    order: list[tuple[str, bool]] = []
    for path, is_mask in sorted(kinds.items()):
        around = next((kind for other, kind in reversed(order) if path.startswith(f"{other}/")), True)
        if around != is_mask:  # a mask in what is shown, or something shown in what is not
            order.append((path, is_mask))
    return order


def _show(root: str, path: str) -> None:
    target = Path(f"{root}{path}")
    if not (os.path.isdir(path) or os.path.isfile(path)):  # noqa: PTH112, PTH113
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    if os.path.islink(path):  # noqa: PTH114 - /bin is one to usr/bin on most systems
        with suppress(FileExistsError):
            target.symlink_to(os.path.realpath(path))  # its own text may lead through other links
    else:
        target.mkdir(exist_ok=True) if os.path.isdir(path) else target.touch()  # noqa: PTH112
        bind(path, str(target))


def _mask(root: str, path: str) -> None:
    if os.path.isdir(path) and os.path.isdir(f"{root}{path}"):  # noqa: PTH112
        mount_memory(f"{root}{path}", _ROOT_MB)
    elif os.path.isfile(path) and os.path.isfile(f"{root}{path}"):  # noqa: PTH113
        empty = Path(f"{root}/.empty")
        empty.touch()
        bind(str(empty), f"{root}{path}")
        empty.unlink()  # what is mounted stays


def _mount(source: str, target: str, kind: str, flags: int, options: str = "") -> None:
    arguments = [os.fsencode(text) or None for text in (source, target, kind)]
    data = os.fsencode(options) or None
    libc.call_libc("mount", *arguments, ctypes.c_ulong(flags), data, what=f"mount {kind or source} on {target}")


def detach_mounts() -> None:
    """Keep what is mounted from now on out of the sight of every other process."""
    _mount("", "/", "", _MS_REC | _MS_PRIVATE)


def bind(source: str, target: str) -> None:
    """Show a file or folder, with all that is mounted in it, at a second place."""
    _mount(source, target, "", _MS_BIND | _MS_REC)


def mount_memory(target: str, megabytes: int, *, mode: int = 0o755, user: int = 0) -> None:
    """Mount an empty file system in memory, gone with the last process that sees it."""
    owner = f",uid={user},gid={user}" if user else ""
    _mount("tmpfs", target, "tmpfs", _MS_NOSUID | _MS_NODEV, f"size={megabytes}m,nr_inodes=4096,mode={mode:o}{owner}")


def _make_read_only(folder: str, *, devices: bool = False) -> None:
    """Make all that is mounted at a folder and below it read-only and its set-uid programs ordinary ones."""
    attributes = _ATTR_RDONLY | _ATTR_NOSUID | (0 if devices else _ATTR_NODEV)
    packed = struct.pack("QQQQ", attributes, 0, 0, 0)
    where = (ctypes.c_int(_AT_FDCWD), os.fsencode(folder), ctypes.c_uint(_AT_RECURSIVE))
    size = ctypes.c_size_t(len(packed))
    libc.system_call(_SYS_MOUNT_SETATTR, *where, packed, size, what=f"mount_setattr {folder}")


def _change_root(folder: str) -> None:
    """Make a mount point the root of all file names; what was mounted before is out of reach from then on."""
    number = _SYS_PIVOT_ROOT[os.uname().machine]
    os.chdir(folder)
    # The old root comes to lie on top of the new one, from where it is taken away: no folder is needed for it.
    libc.system_call(number, b".", b".", what="pivot_root")
    libc.call_libc("umount2", b".", _MNT_DETACH, what="umount the old root")
    os.chdir("/")


def landlock_version() -> int:
    """The kernel's version of Landlock, 0 where it has none or it is switched off."""
    with suppress(OSError):
        return _make_rules(None, 0, _VERSION)
    return 0


def restrict(view: FileView, writable: Iterable[str]) -> None:
    """Have Landlock open nothing for this process, and all it will start, but the view and what is writable."""
    kernel = landlock_version()
    rights = _FIRST_RIGHTS | sum(right for since, right in _LATER_RIGHTS if kernel >= since)
    by_tcp, outside = _BY_TCP * (kernel >= _TCP_SINCE), _OUTSIDE * (kernel >= _OUTSIDE_SINCE)
    attributes = struct.pack("=QQQ", rights, by_tcp, outside)  # a kernel that knows fewer takes zeros behind them
    rules = _make_rules(attributes, len(attributes))
    try:
        for path, only_names in _list_readable(view):
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


def _list_readable(view: FileView) -> Iterator[tuple[str, bool]]:
    """The view without its masks, which Landlock does not know: paths, and of which folders only names are seen."""
    for path, is_mask in _in_order(replace(view, links=())):
        if not is_mask:
            yield from _list_around_masks(path, view.masked)
    yield from ((f"/dev/{name}", False) for name in _DEVICES[1:])
    yield "/proc", False


def _list_around_masks(path: str, masked: Iterable[str]) -> Iterator[tuple[str, bool]]:
    masks = [mask for mask in masked if mask.startswith(f"{path}/")]
    yield path, bool(masks)
    if not masks:
        return
    with os.scandir(path) as entries:
        for entry in entries:
            if entry.path not in masks and not entry.is_symlink():
                yield from _list_around_masks(entry.path, masks)
