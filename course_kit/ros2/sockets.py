"""Who is in a ROS domain on this machine, told by the kernel rather than by waiting.

Every participant binds a UDP port for discovery, 7400 + 250 * domain + 10 + 2 * participant (DDSI-RTPS, 9.6.2.2).
With the course's loopback discovery all peers are on this machine, so the bound ports say how many participants
discovery has still to find: an empty graph is known at once, and a listing never ends before all are found.
"""

from __future__ import annotations

import os

from course_kit import environment

_PORT_BASE, _DOMAIN_GAIN, _FIRST_UNICAST = 7400, 250, 10
_TABLES = ("/proc/net/udp", "/proc/net/udp6")
_LOCAL_ADDRESS, _INODE = 1, 9


def is_local_only() -> bool:
    """Whether everybody this process can meet has a socket in the tables of this machine."""
    return (
        environment.apply().only_this_machine
        and not os.environ.get("ROS_STATIC_PEERS")
        and os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps")
        and not os.environ.get("ROS_DISCOVERY_SERVER")
        and os.access(_TABLES[0], os.R_OK)
    )


def participants(domain_id: int) -> frozenset[int]:
    """The inodes of the discovery sockets bound in `domain_id`, one for each participant, this process's included.

    An inode, unlike a port number, is not taken over by the next process when one ends.
    """
    first = _PORT_BASE + _DOMAIN_GAIN * domain_id
    ports = range(first + _FIRST_UNICAST, first + _DOMAIN_GAIN, 2)
    return frozenset(inode for table in _TABLES for port, inode in _bound(table) if port in ports)


def _bound(table: str) -> list[tuple[int, int]]:
    try:
        with open(table, encoding="ascii") as lines:  # noqa: PTH123 - pathlib is an import a fast command does without
            rows = [line.split() for line in lines][1:]
    except OSError:
        return []
    return [(int(row[_LOCAL_ADDRESS].rpartition(":")[2], 16), int(row[_INODE])) for row in rows]
