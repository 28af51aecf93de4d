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
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S + 1))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_MB << 20, MEMORY_MB << 20))
    resource.setrlimit(resource.RLIMIT_FSIZE, (ANSWER_BYTES, ANSWER_BYTES))
    resource.setrlimit(resource.RLIMIT_NOFILE, (_FILES, _FILES))
    resource.setrlimit(resource.RLIMIT_NPROC, (0, 0))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
