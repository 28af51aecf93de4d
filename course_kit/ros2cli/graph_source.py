"""Gets the graph for a verb: at once when nobody is there, else from the daemon, else by looking itself."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.ros2cli import sockets
from course_kit.ros2cli.daemon_socket import DaemonSocket
from course_kit.ros2cli.graph import Graph

if TYPE_CHECKING:
    from course_kit.ros2cli.session import Session

_START_WITHIN = 10.0


def graph_for(session: Session, timeout: float, *, daemon: bool = True) -> Graph:
    """The settled graph without the nodes of this command."""
    if session.in_kernel or session.has_node or not daemon:
        return session.observe(timeout)
    environment.apply()
    if nobody_there():
        return Graph.empty()
    reply = ask_daemon(timeout)
    return Graph.from_json(reply) if reply else session.observe(timeout)


def nobody_there() -> bool:
    """Whether no participant at all is in the domain, the daemon included."""
    return sockets.is_local_only() and not sockets.participants(int(os.environ["ROS_DOMAIN_ID"]))


def ask_daemon(timeout: float) -> dict[str, Any] | None:
    """The reply of the daemon, started when there is none; None when that fails."""
    request = {"do": "graph", "patience": timeout}
    try:
        daemon_socket = DaemonSocket.here()
        reply = daemon_socket.ask(request, timeout + 1.0)
        if reply is None:
            with daemon_socket.starting():
                reply = daemon_socket.ask(request, timeout + 1.0)
                if reply is None and _start():
                    reply = daemon_socket.ask(request, timeout + 1.0)
    except OSError:  # no writable place for a socket: the command looks for itself
        return None
    return reply


def stop_daemon() -> bool:
    """Stop the daemon of these settings; whether there was one."""
    environment.apply()
    return DaemonSocket.here().ask({"do": "stop"}, 5.0) is not None


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
    with process.stdout as said:
        ready = bool(select.select([said], [], [], _START_WITHIN)[0]) and said.readline() == b"ready\n"
    process.returncode = 0  # it outlives this process on purpose; no ResourceWarning for that
    return ready
