"""Lines that are served from when they are used: a process for each is forked then, and not before."""

from __future__ import annotations

import select
from typing import TYPE_CHECKING, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


class Pollable(Protocol):
    """A socket, or what is made of one."""

    def fileno(self) -> int:
        """Its descriptor."""


Used = TypeVar("Used", bound=Pollable)


def first_uses(lines: Iterable[Used]) -> Iterator[tuple[Used, tuple[Used, ...]]]:
    """Each line when something comes on it for the first time, or its other end is closed; and those unused so far.

    Ends when there are no more.
    """
    unused = {line.fileno(): line for line in lines}
    poll = select.poll()
    for descriptor in unused:
        poll.register(descriptor, select.POLLIN)
    while unused:
        for descriptor, _ in poll.poll():
            poll.unregister(descriptor)
            line = unused.pop(descriptor)
            yield line, tuple(unused.values())
