"""Forks that run a function of ours, and what a process that is forked again and again does before."""

from __future__ import annotations

import ctypes
import gc
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

_BINDS_AT_ONCE = "LD_BIND_NOW"  # of ld.so(8)
BOUND_AT_ONCE = {_BINDS_AT_ONCE: "1"}  # variables to start such a process with: no fork has to bind functions again


def fork_child(run: Callable[[], object]) -> int:
    """Fork, and have the child run a function and end."""
    if child := os.fork():
        return child
    status = 1
    try:
        run()
        status = 0
    except BaseException:  # noqa: BLE001 - whatever it is ends the child; the parent learns of it by the status
        sys.excepthook(*sys.exc_info())
    finally:
        os._exit(status)


def freeze_memory() -> None:
    """Give back what importing left unused, a fifth of the memory, and keep forks from copying what they look at."""
    if trim := getattr(ctypes.CDLL(None), "malloc_trim", None):  # of glibc
        trim(ctypes.c_size_t(0))
    gc.freeze()


def forget_binding() -> None:
    """Have the programs that this process starts bind as usual; the linker has read its variable already."""
    os.environ.pop(_BINDS_AT_ONCE, None)
