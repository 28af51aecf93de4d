"""What a process settles with its parent, and with the children that others leave to it."""

from __future__ import annotations

import ctypes
import os
import signal

from course_kit.process import libc

_PR_SET_PDEATHSIG, _PR_GET_PDEATHSIG, _PR_SET_NAME, _PR_SET_CHILD_SUBREAPER = 1, 2, 15, 36


def die_with_parent(parent: int = 0, number: signal.Signals = signal.SIGKILL) -> None:
    """Have the kernel end this process when its parent ends (PR_SET_PDEATHSIG).

    Lost when the process enters a user namespace or changes its user.
    """
    libc.prctl(_PR_SET_PDEATHSIG, number, what="PDEATHSIG")
    if parent and os.getppid() != parent:
        os.kill(os.getpid(), number)


def adopt_orphans() -> None:
    """Become the parent of every descendant whose own parent ends (PR_SET_CHILD_SUBREAPER)."""
    libc.prctl(_PR_SET_CHILD_SUBREAPER, 1, what="CHILD_SUBREAPER")


def lacking() -> str:
    """Why this process cannot settle anything with others, as the system says it; empty where it can."""
    try:
        libc.prctl(_PR_GET_PDEATHSIG, ctypes.byref(ctypes.c_int()), what="PDEATHSIG")
    except OSError as problem:
        return problem.strerror or str(problem)
    return ""


def set_name(name: str) -> None:
    """Have `ps` and `top` show this process under a name of at most 15 characters."""
    libc.prctl(_PR_SET_NAME, name.encode(), what="NAME")
