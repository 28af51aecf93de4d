"""For a process that comes to a graph, asks and goes: it is answered at the first try.

Fast DDS announces a participant before it listens, to one port after the other of all that peers may have. Who is there
answers at once, and once: those answers are lost, and each peer is found by its next regular announcement only. So such
a process announces itself to the free ports that come next, and to those that are bound, the highest first.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_kit.environment import LOOPBACK_PROFILE, domains, run_dir, write_atomically
from course_kit.environment.middleware import PROFILE_VARIABLE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

_ALL = "<locator><udpv4><address>127.0.0.1</address></udpv4></locator>"  # means all ports, in their order
_ONE = "<locator><udpv4><port>{}</port><address>127.0.0.1</address></udpv4></locator>"
_PARTICIPANTS = 64  # loopback.xml's maxInitialPeersRange
_AT_ONCE = 8  # so many may begin at the same moment; a participant takes the first free port


@contextmanager
def visit_graph(wanted: bool = True) -> Iterator[bool]:
    """Have this process's first node, if it is made meanwhile, be a visitor's; yields whether it is."""
    profile = _profile() if wanted and os.environ.get(PROFILE_VARIABLE) == str(LOOPBACK_PROFILE) else None
    if profile is None:
        yield False
        return
    os.environ[PROFILE_VARIABLE] = str(profile)
    try:
        yield True
    finally:
        os.environ[PROFILE_VARIABLE] = str(LOOPBACK_PROFILE)


def _profile() -> Path | None:
    domain_id = int(os.environ["ROS_DOMAIN_ID"])
    wanted = "".join(_ONE.format(port) for port in _choose_ports(domains.discovery_ports(domain_id)[:_PARTICIPANTS]))
    try:
        text = LOOPBACK_PROFILE.read_text(encoding="utf-8").replace(_ALL, wanted)
        path = run_dir() / f"visitor_{domain_id}.xml"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            write_atomically(path, text)
    except (OSError, UnicodeDecodeError):
        return None
    return path


def _choose_ports(every: Sequence[int]) -> list[int]:
    """The ports to announce to, those of participants that are there at the end."""
    taken = {number for number, _ in domains.bound_ports()}
    there = [port for port in every if port in taken]
    free = [port for port in every if port not in taken]
    return [*free[:_AT_ONCE], *reversed(there)]
