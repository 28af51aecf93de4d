"""A small process that has already discovered the graph, so that a listing need not wait for it.

The real `ros2` keeps a daemon for the same reason. This one is started by the first command that wants a graph and
leaves with the last node of the domain.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import socket
import sys
import time
import zlib
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.ros.graph import Overview
from course_kit.ros2cli.graph import Graph, is_local_only, participant_sockets

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from course_kit.ros2cli.observe import Observer
    from course_kit.ros2cli.session import Session

# What decides who a node meets; a daemon serves only commands with the same settings.
_SETTINGS = (
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ROS_DISCOVERY_SERVER",
    "RMW_IMPLEMENTATION",
    environment.middleware.PROFILE_VARIABLE,
    "FASTDDS_BUILTIN_TRANSPORTS",
)


class DaemonSocket:
    """The place for one set of settings."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder
        self.name = name

    @classmethod
    def for_settings(cls) -> DaemonSocket:
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
    def lock_start(self) -> Iterator[None]:
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


_START_WITHIN = 10.0


def graph_for(session: Session, timeout: float, *, daemon: bool = True) -> Graph:
    """The settled graph without the nodes of this command."""
    if session.in_kernel or session.has_node or not daemon:
        return session.observe(timeout)
    environment.apply_settings()
    if nobody_there():
        return Graph(Overview((), ()), {}, {}, {}, {})
    reply = ask_daemon(timeout)
    return Graph.from_json(reply) if reply else session.observe(timeout)


def nobody_there() -> bool:
    """Whether no participant at all is in the domain, the daemon included."""
    return is_local_only() and not participant_sockets(int(os.environ["ROS_DOMAIN_ID"]))


def ask_daemon(timeout: float) -> dict[str, Any] | None:
    """The reply of the daemon, which is started if it does not run; None when that fails."""
    request = {"do": "graph", "patience": timeout}
    try:
        daemon_socket = DaemonSocket.for_settings()
        reply = daemon_socket.ask(request, timeout + 1.0)
        if reply is None:
            with daemon_socket.lock_start():
                reply = daemon_socket.ask(request, timeout + 1.0)
                if reply is None and _start():
                    reply = daemon_socket.ask(request, timeout + 1.0)
    except OSError:  # no writable place for a socket: the command looks for itself
        return None
    return reply


def _start() -> bool:
    import select
    import subprocess

    process = subprocess.Popen(
        [sys.executable, "-m", "course_kit.ros2cli.daemon"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # a Ctrl-C or the end of the terminal is not for the daemon
        cwd=environment.state_dir(),
        env=environment.child_environment(),
    )
    assert process.stdout is not None  # noqa: S101 - for the type checker: it is a pipe
    with process.stdout as output:
        ready = bool(select.select([output], [], [], _START_WITHIN)[0]) and output.readline() == b"ready\n"
    process.returncode = 0  # it outlives this process on purpose; no ResourceWarning for that
    return ready


ALONE_FOR = 2.0  # seconds without another node in the domain; as long as a killed node is remembered
UNUSED_FOR = 900.0
_CHECK_EVERY = 0.5
_CLIENT_PATIENCE = 5.0


def main() -> None:
    """Serve graphs until the domain is empty, nobody asks, or a client says stop."""
    environment.apply_settings()  # while the command that has started us still holds the domain
    daemon_socket = DaemonSocket.for_settings()
    with daemon_socket.listen() as listening:
        output = os.dup(sys.stdout.fileno())
        _let_go_of_terminal()
        from course_kit.ros2cli.observe import open_observer

        with open_observer(name=f"_ros2cli_daemon_{os.environ['ROS_DOMAIN_ID']}") as looking:
            looking.graph(0.0)  # loads the rest of rclpy: who asks first waits no longer than others
            os.write(output, b"ready\n")
            os.close(output)
            _serve(listening, looking, daemon_socket)


def _let_go_of_terminal() -> None:
    """Nobody reads this process's output; what ROS prints must not reach a notebook's cell."""
    null = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(null, descriptor)
    os.close(null)


def _serve(listening: socket.socket, looking: Observer, daemon_socket: DaemonSocket) -> None:
    listening.settimeout(_CHECK_EVERY)
    domain_id = int(os.environ["ROS_DOMAIN_ID"])
    asked = company = time.monotonic()
    while True:
        now = time.monotonic()
        if not is_local_only() or len(participant_sockets(domain_id)) > 1:
            company = now
        if now - company > ALONE_FOR or now - asked > UNUSED_FOR or not daemon_socket.is_ours(listening):
            return
        try:
            client, _ = listening.accept()
        except TimeoutError:
            continue
        asked = time.monotonic()
        with client, contextlib.suppress(OSError):  # a client that has gone is no concern of the daemon
            client.settimeout(_CLIENT_PATIENCE)
            if not _answer_request(client, looking):
                return


def _answer_request(client: socket.socket, looking: Observer) -> bool:
    """Answer one request; False when it was to stop."""
    request = json.loads(client.makefile("r").readline() or "{}")
    if request.get("do") == "stop":
        client.sendall(b"{}\n")
        return False
    reply = {**looking.graph(request.get("patience", 1.0)).to_json(), "process_id": os.getpid()}
    client.sendall(json.dumps(reply).encode())
    return True


if __name__ == "__main__":
    main()
