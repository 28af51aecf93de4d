"""Who is in a ROS domain on this machine, told by the kernel rather than by waiting.

Every participant binds a UDP port for discovery. With the course's loopback discovery all peers are on this machine, so
the bound ports say how many participants discovery has still to find: an empty graph is known at once, and a listing
never ends before all are found.
"""

from __future__ import annotations

import os

from course_kit import environment
from course_kit.environment import domains


def is_local_only() -> bool:
    """Whether everybody this process can meet has a socket in the tables of this machine."""
    return (
        environment.apply().only_this_machine
        and not os.environ.get("ROS_STATIC_PEERS")
        and os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps")
        and not os.environ.get("ROS_DISCOVERY_SERVER")
        and domains.are_told()
    )


def participants(domain_id: int) -> frozenset[int]:
    """The inodes of the discovery sockets bound in `domain_id`, one for each participant, this process's included."""
    wanted = domains.discovery_ports(domain_id)
    return frozenset(inode for number, inode in domains.bound() if number in wanted)
