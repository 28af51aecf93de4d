"""ROS domains as leases: no two courses, and no two graders, on one machine ever share a graph.

A domain stands for UDP ports: whoever uses the same one in the same network namespace sees the same graph. So a lease
is a port, too, one that RTPS leaves free in the domain's own block; the kernel takes it back when the process ends. The
numbers 1 to 101 are leased (safe beside the kernel's ephemeral ports); 0 is left to the user's own robots.

*Exclusive*: one socket binds the domain's lease port. *Shared*: every process of an owner binds it with SO_REUSEPORT,
which the kernel grants to processes of one user only. To find each other, and no other owner, each also binds a mark: a
port of the domain on a loopback address that is made of the owner's name.
"""

from __future__ import annotations

import errno
import os
import socket
import threading
import time
import zlib
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator

FIRST, LAST = 1, 101
# A domain is a block of 250 ports from 7400 + 250 * domain on (DDSI-RTPS, 9.6.2). Participants use places 0 and 1 of it
# for multicast, and from place 10 on two each for themselves. The eight places between are nobody's.
_BASE, _GAIN = 7400, 250
_MULTICAST, _FIRST_UNICAST = 2, 10
_LOOKS = 3
_TABLES = ("/proc/net/udp", "/proc/net/udp6")
_LOCAL_ADDRESS, _INODE = 1, 9
_LEASE, _MARK, _CHOICE = 2, 3, 4  # places in a domain's block of ports that RTPS does not use
_LOOPBACK, _DISCARD = "127.0.0.1", 9  # the port of the discard service (RFC 863), which no machine runs
_CHOICE_LOOK_S = 0.002
_CHOICE_S = 10.0


def port_at(domain_id: int, place: int) -> int:
    """The port at a place, 0 to 249, of a domain's block."""
    return _BASE + _GAIN * domain_id + place


def discovery_ports(domain_id: int) -> range:
    """The ports of which every participant in the domain binds one, to be found through."""
    return range(port_at(domain_id, _FIRST_UNICAST), port_at(domain_id + 1, 0), 2)


def can_read_ports() -> bool:
    """Whether this machine lets us read which ports are bound."""
    return os.access(_TABLES[0], os.R_OK)


def bound_ports() -> list[tuple[int, int]]:
    """The bound UDP ports of this network namespace, each with its socket's inode; none where /proc does not tell."""
    # More than once: while others' sockets come and go, the kernel leaves out rows of one look.
    return sorted({row for _ in range(_LOOKS) for table in _TABLES for row in _rows(table)})


def domains_in_use() -> frozenset[int]:
    """The domains with a participant of whatever program, as far as /proc tells."""
    places = (divmod(number - _BASE, _GAIN) for number, _ in bound_ports())
    return frozenset(domain_id for domain_id, place in places if place < _MULTICAST or place >= _FIRST_UNICAST)


def _rows(table: str) -> list[tuple[int, int]]:
    try:
        with open(table, encoding="ascii") as lines:  # noqa: PTH123 - pathlib is an import a fast command does without
            rows = [line.split() for line in lines][1:]
    except OSError:
        return []
    return [(int(row[_LOCAL_ADDRESS].rpartition(":")[2], 16), int(row[_INODE])) for row in rows]


class DomainError(RuntimeError):
    """This process gets no ROS domain to work in; the message says why and what to do."""

    def _render_traceback_(self) -> list[str]:
        """IPython's hook for exceptions that print themselves: in a notebook the message alone matters."""
        return [f"{type(self).__name__}: {self}"]


class SettingsError(DomainError, ValueError):
    """A value the user has set cannot be used."""


class NoDomainError(DomainError):
    """Every domain of this machine is in use."""

    def __init__(self) -> None:
        super().__init__(
            f"All ROS domains from {FIRST} to {LAST} on this machine are in use by courses or graders. "
            "Close some of them, or set ROS_DOMAIN_ID to a number you know is free: 215 to 232 are never given out."
        )


class NoLoopbackError(DomainError):
    """There is no network over which the course's nodes could meet."""

    def __init__(self) -> None:
        super().__init__(
            f"The address {_LOOPBACK} does not work here, but the course's nodes need it. Switch on the "
            "loopback interface of this machine or container, with 'ip link set lo up' as root."
        )


@dataclass
class Lease:
    """A domain this process may use until it lets go of it."""

    domain_id: int
    _descriptors: tuple[int, ...]

    def release(self) -> None:
        """Give the domain back. Safe to call twice."""
        for descriptor in self._descriptors:
            os.close(descriptor)
        self._descriptors = ()


class Leases:
    """The leases in the network namespace of this process."""

    def __init__(self, scope: str = "", occupied: Callable[[], Container[int]] = domains_in_use) -> None:
        self._scope = scope
        self._address = _address(scope) if scope else _LOOPBACK
        self._occupied = occupied

    def share(self, owner: str) -> Lease:
        """Lease the domain of `owner`, together with every other process of the same user and owner."""
        candidates = _candidates(owner)
        mark = _address(f"{self._scope} {_realm()} {owner}")
        with self._choice():
            for domain_id in candidates:
                if _is_bound(mark, port_at(domain_id, _MARK)) and (lease := self._join(domain_id, mark)):
                    return lease
            for domain_id in candidates:
                free = not _is_bound(self._address, port_at(domain_id, _LEASE))
                if free and (lease := self._join(domain_id, mark)):
                    return lease
        raise NoDomainError

    def lease_exclusive(self) -> Lease:
        """Lease a domain nobody else uses."""
        occupied = self._occupied()
        for domain_id in range(LAST, FIRST - 1, -1):
            if domain_id in occupied:
                continue
            descriptor = _bind(self._address, port_at(domain_id, _LEASE))
            if descriptor is not None:
                return Lease(domain_id, (descriptor,))
        raise NoDomainError

    def _join(self, domain_id: int, mark: str) -> Lease | None:
        """Hold a domain beside others of the owner; None when it is somebody else's."""
        held: list[int] = []
        for address, place in ((mark, _MARK), (self._address, _LEASE)):
            descriptor = _bind(address, port_at(domain_id, place), shared=True)
            if descriptor is None:
                Lease(domain_id, tuple(held)).release()
                return None
            held.append(descriptor)
        return Lease(domain_id, tuple(held))

    @contextmanager
    def _choice(self) -> Iterator[None]:
        """One process at a time, of all in this network namespace, chooses which domain it shares."""
        deadline = time.monotonic() + _CHOICE_S
        pause = threading.Event()
        while (held := _bind(self._address, port_at(0, _CHOICE))) is None and time.monotonic() < deadline:
            pause.wait(_CHOICE_LOOK_S)
        try:
            yield
        finally:
            if held is not None:
                os.close(held)


@contextmanager
def exclusive_domain() -> Iterator[int]:
    """`Leases.lease_exclusive` as a context manager that yields the domain's number."""
    lease = Leases().lease_exclusive()
    try:
        yield lease.domain_id
    finally:
        lease.release()


def _candidates(owner: str) -> list[int]:
    count = LAST - FIRST + 1
    start = zlib.crc32(owner.encode()) % count
    return [FIRST + (start + step) % count for step in range(count)]


def _realm() -> str:
    """The user, and the root directory: in another container the same user and path may be another person's course."""
    root = os.stat("/")  # noqa: PTH116 - a fast command does without pathlib
    return f"{os.getuid()} {root.st_dev} {root.st_ino}"


def _address(name: str) -> str:
    """An address for a name, one of the 16 million of the loopback interface."""
    first, second, last = zlib.crc32(name.encode()).to_bytes(4, "big")[1:]
    return f"127.{first}.{second}.{1 + last % 254}"


def _is_bound(address: str, port: int) -> bool:
    descriptor = _bind(address, port)
    if descriptor is not None:
        os.close(descriptor)
    return descriptor is None


def _bind(address: str, port: int, *, shared: bool = False) -> int | None:
    """The descriptor of a socket that holds a port from now on; None when somebody else holds it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as holder:
        if shared:
            holder.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        try:
            holder.bind((address, port))
            # Sends nothing. The kernel drops from now on what others send; it fails where loopback is switched off.
            holder.connect((_LOOPBACK, _DISCARD))
        except OSError as problem:
            if problem.errno in (errno.EADDRNOTAVAIL, errno.ENETUNREACH):
                raise NoLoopbackError from None
            return None
        return holder.detach()
