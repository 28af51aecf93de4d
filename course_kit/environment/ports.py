"""The UDP ports of ROS domains, and which of them are bound, told by the kernel.

A domain is a block of 250 ports from 7400 + 250 * domain on (DDSI-RTPS, 9.6.2). Participants use places 0 and 1 of it
for multicast, and from place 10 on two each for themselves. The eight places between are nobody's.
"""

from __future__ import annotations

import os

_BASE, _GAIN = 7400, 250
_MULTICAST, _FIRST_UNICAST = 2, 10
_TABLES = ("/proc/net/udp", "/proc/net/udp6")
_LOCAL_ADDRESS, _INODE = 1, 9


def port(domain_id: int, place: int) -> int:
    """The port at a place, 0 to 249, of a domain's block."""
    return _BASE + _GAIN * domain_id + place


def discovery_ports(domain_id: int) -> range:
    """The ports of which every participant in the domain binds one, to be found through."""
    return range(port(domain_id, _FIRST_UNICAST), port(domain_id + 1, 0), 2)


def are_told() -> bool:
    """Whether this machine lets us read which ports are bound."""
    return os.access(_TABLES[0], os.R_OK)


def bound() -> list[tuple[int, int]]:
    """The bound UDP ports of this network namespace, each with its socket's inode; none where /proc does not tell."""
    return [row for table in _TABLES for row in _rows(table)]


def domains_in_use() -> frozenset[int]:
    """The domains with a participant of whatever program, as far as /proc tells."""
    places = (divmod(number - _BASE, _GAIN) for number, _ in bound())
    return frozenset(domain_id for domain_id, place in places if place < _MULTICAST or place >= _FIRST_UNICAST)


def _rows(table: str) -> list[tuple[int, int]]:
    try:
        with open(table, encoding="ascii") as lines:  # noqa: PTH123 - pathlib is an import a fast command does without
            rows = [line.split() for line in lines][1:]
    except OSError:
        return []
    return [(int(row[_LOCAL_ADDRESS].rpartition(":")[2], 16), int(row[_INODE])) for row in rows]
