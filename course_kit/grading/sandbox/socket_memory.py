"""Memory that sockets take: what was sent and nobody has received lies in the kernel, and in no process (socket(7)).

Counted where a submission has a network to itself. The kernel tells it of UDP alone. Any other socket counts with as
much as it can hold, which is its usual buffers: the filter of system calls grants no larger ones (`seccomp`), and TCP
has no others there (`bound_tcp`).
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

_USUAL = 212992  # bytes: the usual buffer of a socket in one direction (net.core.rmem_default and wmem_default)
_MOST = 4 * _USUAL  # where somebody has given all sockets of a machine larger ones, a few sockets are no offence
_UDP = ("/proc/net/udp", "/proc/net/udp6")
_TCP = ("/proc/sys/net/ipv4/tcp_rmem", "/proc/sys/net/ipv4/tcp_wmem")


def _default(name: str) -> int:
    with suppress(OSError, ValueError):
        return int(Path(f"/proc/sys/net/core/{name}").read_text(encoding="ascii"))
    return _USUAL


# Read at first: not every kernel shows it in a network namespace.
_RECEIVED, _SENT = _default("rmem_default"), _default("wmem_default")
_OF_UDP = _RECEIVED + _SENT
_OF_OTHERS = 2 * min(max(_SENT, _USUAL), _MOST)


def bound_tcp() -> None:
    """Give TCP in the network namespace of this process no larger buffers than other sockets have."""
    for path in _TCP:
        Path(path).write_text(f"4096 65536 {_USUAL}", encoding="ascii")


def number_here() -> int:
    """How many sockets this network namespace has: closed ones of which nobody has received all are among them."""
    with suppress(OSError, ValueError, IndexError):
        text = Path("/proc/net/sockstat").read_text(encoding="ascii")
        return int(text.partition("sockets: used ")[2].split()[0])
    return 0


def at_most(sockets: int) -> int:
    """Bytes that so many sockets can hold."""
    return sockets * max(_OF_UDP, _OF_OTHERS)


def in_use(sockets: int) -> int:
    """Bytes that the sockets of this network namespace count with, so many as `number_here` has said."""
    queued = [line.split()[4].split(":") for path in _UDP for line in _rows(path)]
    of_udp = sum(int(sent, 16) + int(received, 16) for sent, received in queued)
    return of_udp + _OF_OTHERS * max(0, sockets - len(queued))


def _rows(path: str) -> list[str]:
    with suppress(OSError):
        return Path(path).read_text(encoding="ascii").splitlines()[1:]
    return []
