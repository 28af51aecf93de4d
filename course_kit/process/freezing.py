"""What a process does before it is forked again and again: a fork costs what its memory costs."""

from __future__ import annotations

import ctypes
import gc
import os

_BINDS_AT_ONCE = "LD_BIND_NOW"  # of ld.so(8)
BOUND_AT_ONCE = {_BINDS_AT_ONCE: "1"}  # variables to start such a process with: no fork has to bind functions again


def freeze() -> None:
    """Give back the memory that nothing uses any more, and keep the forks from copying what they only look at.

    Importing leaves a fifth of the memory unused. Each fork would have to be given it, and would copy it before use.
    """
    if trim := getattr(ctypes.CDLL(None), "malloc_trim", None):  # of glibc
        trim(ctypes.c_size_t(0))
    gc.freeze()


def forget_binding() -> None:
    """Have the programs that this process starts bind as usual; the linker has read its variable already."""
    os.environ.pop(_BINDS_AT_ONCE, None)
