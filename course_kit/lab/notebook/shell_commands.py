"""`!command` in a cell: all that a program prints is shown, also by one that ends the moment it has printed it.

IPython runs such a command by pexpect (4.9), which looks every 0.05 s whether there is output, and when there is none,
whether the program has ended. What is printed between these two looks is lost when the program ends as quickly. That
is seldom, but not in a kernel whose threads take turns.
"""

from __future__ import annotations

import select
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.lab.overrides.patches import Patches


def show_all_output(patches: Patches) -> None:
    """Have pexpect look for output once more when a program has ended."""
    try:
        from pexpect import EOF, spawn
    except ImportError:  # IPython needs it only where there are pseudoterminals
        return
    read = spawn.read_nonblocking

    def read_to_the_end(program: Any, size: int = 1, timeout: float | None = -1) -> Any:
        try:
            return read(program, size, timeout)
        except EOF:
            if not _has_more(program.child_fd):
                raise
            return super(spawn, program).read_nonblocking(size)

    patches.set(spawn, "read_nonblocking", read_to_the_end)


def _has_more(descriptor: int) -> bool:
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    return any(event & select.POLLIN for _, event in poll.poll(0))
