"""The socket between the command and its daemon: one for each set of ROS settings in the user's state directory."""

from __future__ import annotations

import fcntl
import json
import os
import socket
import sys
import zlib
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

# What decides who a node meets; a daemon serves only commands with the same settings.
_SETTINGS = (
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ROS_DISCOVERY_SERVER",
    "RMW_IMPLEMENTATION",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "FASTDDS_BUILTIN_TRANSPORTS",
)


class DaemonSocket:
    """The place for one set of settings."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder
        self.name = name

    @classmethod
    def here(cls) -> DaemonSocket:
        """The place for this process's settings, which `environment.apply` has made."""
        code = str((environment.PACKAGE / "ros2cli").stat().st_mtime_ns)  # a daemon of an older kit is not asked
        python = os.path.realpath(sys.prefix)  # a kernel may know it by a link, such as .venv
        settings = "\0".join([python, code, _network(), *(os.environ.get(name, "") for name in _SETTINGS)])
        folder = environment.state_dir() / "daemons"
        folder.mkdir(mode=0o700, exist_ok=True)
        return cls(folder, f"{os.environ['ROS_DOMAIN_ID']}-{zlib.crc32(settings.encode()):08x}")

    @contextmanager
    def listen(self) -> Iterator[socket.socket]:
        """The daemon's end; the socket's file is removed afterwards, unless it is somebody else's by then."""
        with self._address() as address, socket.socket(socket.AF_UNIX) as listening:
            (self._folder / self.name).unlink(missing_ok=True)
            listening.bind(address)
            listening.listen()
            self._inode = self._file_inode()
            try:
                yield listening
            finally:
                if self.is_ours(listening):
                    (self._folder / self.name).unlink(missing_ok=True)

    def is_ours(self, listening: socket.socket) -> bool:
        """Whether the file still leads to this process: a removed or replaced one means that nobody can ask."""
        return listening.fileno() >= 0 and self._file_inode() == self._inode

    def ask(self, request: dict[str, Any], timeout: float) -> dict[str, Any] | None:
        """The daemon's reply, or None when there is no daemon or it does not answer within `timeout` seconds."""
        try:
            with self._address() as address, socket.socket(socket.AF_UNIX) as asking:
                asking.settimeout(timeout)
                asking.connect(address)
                asking.sendall(json.dumps(request).encode() + b"\n")
                with asking.makefile("rb") as reply:
                    return dict(json.loads(reply.read()))
        except (OSError, ValueError):
            return None

    @contextmanager
    def starting(self) -> Iterator[None]:
        """Only one process at a time starts a daemon here."""
        descriptor = os.open(self._folder / f"{self.name}.lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            yield
        finally:
            os.close(descriptor)

    @contextmanager
    def _address(self) -> Iterator[str]:
        """A short name for the socket: its own path may be longer than the 107 bytes an address may have."""
        descriptor = os.open(self._folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            yield f"/proc/self/fd/{descriptor}/{self.name}"
        finally:
            os.close(descriptor)

    def _file_inode(self) -> int | None:
        try:
            return (self._folder / self.name).stat().st_ino
        except OSError:
            return None


def _network() -> str:
    """This process's network namespace: containers with one home directory may have different graphs on one domain."""
    try:
        return os.readlink("/proc/self/ns/net")  # noqa: PTH115 - as above, without pathlib
    except OSError:
        return ""
