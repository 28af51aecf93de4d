"""What a submission may use, and how the kernel enforces it; the init process watches memory and time."""

from __future__ import annotations

import resource
from typing import Annotated, TypeAlias

import msgspec

_MB = 1024 * 1024
# Stacks and arenas of the threads that ROS 2 starts: address space that is reserved and hardly touched.
RESERVED_MB = 512
_READER_MB = 1024
_Number: TypeAlias = Annotated[float, msgspec.Meta(gt=0)]
_Whole: TypeAlias = Annotated[int, msgspec.Meta(gt=0)]
SPARE_TASKS = 32  # the kernel's own stop lies above the one that is reported


class Limits(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The limits of one exercise, `[limits]` in its exercise.toml."""

    start_s: _Number = 5.0  # seconds from the program's start until it can be asked
    # seconds of computing after which a program is given up before that, if none of its nodes has appeared; a right one
    # needs 0.1 s until then. Commands have yet to load everything, and are not held to it
    start_cpu_s: _Number = 2.0
    cpu_s: _Whole = 20  # seconds of computing, all threads of a process together
    wall_s: _Number = 60.0  # seconds for the whole grading, however much of it is waiting
    memory_mb: _Whole = 256  # resident memory of all its processes together
    tasks: _Whole = 128  # processes and threads together; ROS 2 itself needs about 15 threads a program
    file_mb: _Whole = 16  # size of one file it writes, and of everything in its scratch directory together
    open_files: _Whole = 256  # file descriptors of a process
    output_kb: _Whole = 2048  # what it may write to stdout and stderr together


def apply_to_this_process(limits: Limits, others: int) -> None:
    """Have the kernel hold this process, and everything it starts, to `limits`."""
    data = (limits.memory_mb + RESERVED_MB) * _MB
    # One second between the signal that ends the program (SIGXCPU) and the one nobody can catch.
    _lower_limit(resource.RLIMIT_CPU, limits.cpu_s, limits.cpu_s + 1)
    _lower_limit(resource.RLIMIT_DATA, data, data)
    tasks = limits.tasks + SPARE_TASKS + others
    _lower_limit(resource.RLIMIT_NPROC, tasks, tasks)
    _lower_limit(resource.RLIMIT_FSIZE, limits.file_mb * _MB, limits.file_mb * _MB)
    _lower_limit(resource.RLIMIT_NOFILE, limits.open_files, limits.open_files)
    _lower_limit(resource.RLIMIT_CORE, 0, 0)


def bound_reader(seconds: float) -> None:
    """Bound this process of the grader, which reads what a submission sends."""
    _lower_limit(resource.RLIMIT_DATA, _READER_MB * _MB, _READER_MB * _MB)
    _lower_limit(resource.RLIMIT_CPU, int(seconds) + 1, int(seconds) + 2)
    _lower_limit(resource.RLIMIT_CORE, 0, 0)


def _lower_limit(what: int, soft: int, hard: int) -> None:
    _, highest = resource.getrlimit(what)
    if highest != resource.RLIM_INFINITY:
        soft, hard = min(soft, highest), min(hard, highest)
    resource.setrlimit(what, (soft, hard))
