"""What the reader and whoever asks it send each other: a small JSON object a packet, with open files beside it.

The two ends are a pair of SOCK_SEQPACKET sockets (unix(7)), which keep packets apart. What is long stands in the files.
"""

from __future__ import annotations

import json
import socket

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any, TypedDict

    class Wish(TypedDict):
        """What is asked for: the work, a submission's name and exercise, and what that wants from it."""

        do: str
        name: str
        exercise: str
        variable: str
        class_name: str


_LARGEST = 64 * 1024  # bytes; a request holds a few names


def send(line: socket.socket, message: Mapping[str, object], files: Sequence[int] = ()) -> None:
    """Send a packet."""
    socket.send_fds(line, [json.dumps(message).encode()], files)


def receive(line: socket.socket, files: int = 0) -> tuple[dict[str, Any], list[int]]:
    """Wait for a packet."""
    data, descriptors, _, _ = socket.recv_fds(line, _LARGEST, files)
    if not data:
        raise EOFError("the other end is closed")
    message = json.loads(data)
    if not isinstance(message, dict) or len(descriptors) != files:
        raise ValueError("that is not a packet")
    return message, descriptors
