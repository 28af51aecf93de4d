"""What the reader and whoever asks it agree on: how much reading may take, and what they send each other.

A packet is a small JSON object with open files beside it, in which long texts stand. The two ends are a pair of
SOCK_SEQPACKET sockets (unix(7)), which keep packets apart.
"""

from __future__ import annotations

import json
import resource
import socket

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

CPU_S = 5  # 1 MiB of ordinary Python takes 0.3 s
MEMORY_MB = 768  # 1 MiB of ordinary Python takes 120 MB, of the densest 700 MB, a notebook of 64 MiB up to 400 MB
WALL_S = 60.0  # what has not computed for CPU_S until then was kept from it by a busy machine
ANSWER_BYTES = 8 << 20  # a program has 1 MiB, and JSON writes a character in up to six
_LARGEST = 64 * 1024  # bytes of a packet; a request holds a few names


def apply_limits() -> None:
    """Hold this process to them; a machine may allow less, and nobody but root more (getrlimit(2))."""
    for what, soft, hard in (
        (resource.RLIMIT_CPU, CPU_S, CPU_S + 1),
        (resource.RLIMIT_AS, MEMORY_MB << 20, MEMORY_MB << 20),
        (resource.RLIMIT_FSIZE, ANSWER_BYTES, ANSWER_BYTES),
        (resource.RLIMIT_NOFILE, 8, 8),
        (resource.RLIMIT_NPROC, 0, 0),
        (resource.RLIMIT_CORE, 0, 0),
    ):
        _, highest = resource.getrlimit(what)
        most = hard if highest == resource.RLIM_INFINITY else min(hard, highest)
        resource.setrlimit(what, (min(soft, most), most))


def send_packet(line: socket.socket, message: Mapping[str, object], files: Sequence[int] = ()) -> None:
    """Send a packet."""
    socket.send_fds(line, [json.dumps(message).encode()], files)


def receive_packet(line: socket.socket, files: int = 0) -> tuple[dict[str, Any], list[int]]:
    """Wait for a packet."""
    data, descriptors, _, _ = socket.recv_fds(line, _LARGEST, files)
    if not data:
        raise EOFError("the other end is closed")
    message = json.loads(data)
    if not isinstance(message, dict) or len(descriptors) != files:
        raise ValueError("that is not a packet")
    return message, descriptors
