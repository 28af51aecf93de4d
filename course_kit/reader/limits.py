"""How much reading one submission may take, and how the kernel is told (getrlimit(2))."""

from __future__ import annotations

import resource

CPU_S = 5  # 1 MiB of ordinary Python takes 0.3 s
MEMORY_MB = 768  # 1 MiB of ordinary Python takes 120 MB, of the densest 700 MB, a notebook of 64 MiB up to 400 MB
WALL_S = 60.0  # what has not computed for CPU_S until then was kept from it by a busy machine
ANSWER_BYTES = 8 << 20  # a program has 1 MiB, and JSON writes a character in up to six
_FILES = 8


def apply() -> None:
    """Hold this process to them."""
    _lower(resource.RLIMIT_CPU, CPU_S, CPU_S + 1)
    _lower(resource.RLIMIT_AS, MEMORY_MB << 20, MEMORY_MB << 20)
    _lower(resource.RLIMIT_FSIZE, ANSWER_BYTES, ANSWER_BYTES)
    _lower(resource.RLIMIT_NOFILE, _FILES, _FILES)
    _lower(resource.RLIMIT_NPROC, 0, 0)
    _lower(resource.RLIMIT_CORE, 0, 0)


def _lower(what: int, soft: int, hard: int) -> None:
    _, highest = resource.getrlimit(what)
    if highest != resource.RLIM_INFINITY:  # this machine may allow less, and nobody but root more
        soft, hard = min(soft, highest), min(hard, highest)
    resource.setrlimit(what, (soft, hard))
