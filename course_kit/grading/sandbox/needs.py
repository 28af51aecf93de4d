"""What a grading needs of the machine. Where that is missing, nobody is to get a zero for it.

A submission is promised so much of everything by its exercise (see `limits`). A machine on which it cannot have that
is said before anything is graded, with what to do about it.
"""

from __future__ import annotations

import os
import platform
import resource
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.grading.model import limits
from course_kit.grading.sandbox import machine
from course_kit.process import tree

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.model.limits import Limits

_KB = 1024
_OWN_TASKS = 40  # processes and threads of the grader beside a submission
_OWN_FILES = 256  # open files of a process of the grader
_ADDRESSES_MB = 512  # address space that ROS 2 takes beside what is counted as a submission's memory
_FEW = 4096  # who may have more tasks than that is not asked how many there are, which takes a look at each of them
_SHARED_MEMORY = "/dev/shm"  # noqa: S108 - only its free space is read
_SHARED_KB = 64  # of shared memory, without which ROS 2 is killed when it is loaded
_PROC = Path("/proc/self/stat")
_AGAIN = ", then grade again."
_OF_A_USER = (
    "You may have {allowed} processes and threads here (ulimit -u), {used} are there, and a grading takes up to "
    f"{{needed}}. End some or allow more (ulimit -u {{more}}){_AGAIN}"
)
_OF_A_GROUP = (
    "This container or service may have {allowed} processes and threads (pids.max), {used} are there, and a grading "
    f"takes up to {{needed}}. Allow more (docker run --pids-limit {{more}}){_AGAIN}"
)


def require_machine(promised: Limits) -> None:
    """See that this machine can grade."""
    for problem in describe_lacks(promised, guest=os.geteuid() == 0):
        raise GradingError(problem)


def count_side_by_side(promised: Limits) -> int:
    """How many submissions that are promised so much this machine has processes for at the same time, at least one."""
    rooms = _task_rooms(guest=False)  # each worker's submissions have their own user, where they have one
    return max(1, min(((allowed - used) // _tasks(promised) for allowed, used, _ in rooms), default=_FEW))


def describe_lacks(promised: Limits, *, guest: bool) -> Iterator[str]:
    """What this machine lacks, and what to do about it, each in one or two sentences."""
    if not sys.platform.startswith("linux"):
        yield (
            f"Grading takes a Linux, and this is {platform.system()}: only there can the grader count and end a "
            "submission's processes. Grade in a container or a virtual machine."
        )
    if not _PROC.exists():
        yield (
            "/proc is missing here, but the grader needs it to count and end a submission's processes. Mount it "
            f"(mount -t proc proc /proc){_AGAIN}"
        )
    data_kb = (promised.memory_mb + limits.RESERVED_MB) * _KB
    for what, option, text, least in (
        (resource.RLIMIT_NOFILE, "-n", "have {} open files", max(promised.open_files, _OWN_FILES)),
        (resource.RLIMIT_AS, "-v", "take {} kB of address space", data_kb + _ADDRESSES_MB * _KB),
        (resource.RLIMIT_DATA, "-d", "take {} kB of memory", data_kb),
        (resource.RLIMIT_CPU, "-t", "compute for {} s", promised.cpu_s + 1),
        (resource.RLIMIT_FSIZE, "-f", "write files of {} kB", promised.file_mb * _KB),
    ):
        allowed = _allowed(what) // (_KB if "kB" in text else 1)
        if allowed < least:
            yield (
                f"A process may {text.format(allowed)} here (ulimit {option}), but a submission is promised {least}. "
                f"Allow more (ulimit {option} {least}, or in /etc/security/limits.conf){_AGAIN}"
            )
    tasks = _tasks(promised)
    for allowed, used, said in _task_rooms(guest=guest):
        if allowed - used < tasks:
            yield said.format(allowed=allowed, used=used, needed=tasks, more=used + tasks)
    with suppress(OSError):  # if it is missing, ROS 2 does without
        found = os.statvfs(_SHARED_MEMORY)
        if found.f_blocks and found.f_bavail * found.f_frsize < _SHARED_KB * _KB:
            yield (
                f"{_SHARED_MEMORY} is full, and ROS 2 needs a little of it. Delete what nobody needs there, or give it "
                f"more room (docker run --shm-size){_AGAIN}"
            )


def _task_rooms(*, guest: bool) -> Iterator[tuple[int, int, str]]:
    """How many processes and threads there may be, how many there are, how to say so; no limit that nobody reaches."""
    allowed = _allowed(resource.RLIMIT_NPROC)
    if guest:  # of whom there is nothing yet
        yield allowed, 0, _OF_A_USER
    elif os.getuid() != 0 and allowed < _FEW:  # the kernel holds root to nothing
        yield allowed, tree.tasks_of_user(os.getuid()), _OF_A_USER
    yield from ((*numbers, _OF_A_GROUP) for numbers in machine.read_groups("pids.max", "pids.current"))


def _tasks(promised: Limits) -> int:
    """Processes and threads that a grading may take."""
    return promised.tasks + limits.SPARE_TASKS + _OWN_TASKS


def _allowed(what: int) -> int:
    """A limit of this process, and of all it starts, as a number that can be compared."""
    limit, _ = resource.getrlimit(what)
    return 2**62 if limit == resource.RLIM_INFINITY else limit
