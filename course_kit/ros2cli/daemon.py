"""A small process that has already discovered the graph, so that a listing need not wait for it.

Discovery takes a new process a few hundred milliseconds (Fast DDS answers a first contact after 100 ms), whatever
the command does. The real `ros2` keeps a daemon for the same reason ("ros2 daemon" in its documentation). This one
is started by the first command that wants a graph and leaves with the last node of the domain.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import time
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.ros2cli import sockets
from course_kit.ros2cli.daemon_socket import DaemonSocket

if TYPE_CHECKING:
    import socket

    from course_kit.ros2cli.observe import Observer

ALONE_FOR = 2.0  # seconds without another node in the domain; as long as a killed node is remembered
UNUSED_FOR = 900.0
_CHECK_EVERY = 0.5
_CLIENT_PATIENCE = 5.0


def main() -> None:
    """Serve graphs until the domain is empty, nobody asks any more, or a client says stop."""
    environment.apply()  # while the command that has started us still holds the domain
    daemon_socket = DaemonSocket.here()
    with daemon_socket.listen() as listening:
        told = os.dup(sys.stdout.fileno())
        _let_go_of_terminal()
        from course_kit.ros2cli.observe import observer

        with observer(name=f"_ros2cli_daemon_{os.environ['ROS_DOMAIN_ID']}") as looking:
            looking.graph(0.0)  # loads the rest of rclpy: who asks first waits no longer than others
            os.write(told, b"ready\n")
            os.close(told)
            _serve(listening, looking, daemon_socket)


def _let_go_of_terminal() -> None:
    """Nobody reads this process any more; what ROS prints must not reach a notebook's cell."""
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
        if not sockets.is_local_only() or len(sockets.participants(domain_id)) > 1:
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
            if not _answer(client, looking):
                return


def _answer(client: socket.socket, looking: Observer) -> bool:
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
