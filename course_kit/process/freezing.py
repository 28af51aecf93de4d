"""What a process does before it is forked again and again: a fork costs what its memory costs."""

from __future__ import annotations

import ctypes
import gc


def freeze() -> None:
    """Give back the memory that nothing uses any more, and keep the forks from copying what they only look at.

    Importing leaves a fifth of the memory unused. Each fork would have to be given it, and would copy it before use.
    """
    if trim := getattr(ctypes.CDLL(None), "malloc_trim", None):  # of glibc
        trim(ctypes.c_size_t(0))
    gc.freeze()
