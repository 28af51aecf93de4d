"""The last step of a process on its way to becoming a submission: it gives up every right for good."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_kit.grading.sandbox import file_view, isolation, landlock, namespaces, seccomp

if TYPE_CHECKING:
    from course_kit.grading.sandbox.sandbox import Conditions


def lock_in(cell: Conditions) -> None:
    """After this the process, and all it starts, can do no more than the submission may."""
    if not cell.isolation.files and cell.isolation.landlock:
        landlock.restrict(file_view.readable(cell.view), (cell.scratch, "/dev/null", "/dev/shm"))  # noqa: S108
    if cell.user:
        isolation.become(cell.user)
    namespaces.drop_privileges()
    namespaces.allow_tracing()  # what it starts may look into /proc/self, as everywhere
    if cell.isolation.syscalls:
        seccomp.install(processes=cell.isolation.processes, files=cell.isolation.files)
    _forget_the_grader()


def _forget_the_grader() -> None:
    """Make the modules of the kit that are not for programs as unknown as their files are."""
    for name in list(sys.modules):
        if name.startswith("course_kit.") and name.split(".")[1] not in file_view.MODULES_OF_KIT:
            del sys.modules[name]
