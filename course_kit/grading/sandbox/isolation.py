"""What isolates a submission from the rest on this machine, found by trying.

Namespaces may be compiled out, switched off, or allowed in name and useless in fact; so each is set up
for real in a child process that is thrown away. The grader then uses what worked, and says so.
"""

from __future__ import annotations

import errno
import os
import sys
import tempfile
from functools import partial
from typing import TYPE_CHECKING

from course_kit.grading.model.job import Isolation
from course_kit.grading.sandbox import file_view, namespaces, seccomp
from course_kit.process.child import fork_child

if TYPE_CHECKING:
    from collections.abc import Callable

_REASONS = {
    errno.ENOSPC: "this machine allows no more user namespaces (sysctl user.max_user_namespaces): ",
    errno.EPERM: "this machine forbids user namespaces (AppArmor on Ubuntu, or the container it runs in): ",
    errno.ENOSYS: "this kernel is too old: ",
    errno.EINVAL: "this kernel lacks a kind of namespace: ",
}


# Numbers that systemd hands out to services for as long as they run, and that containers have, too.
_FIRST_GUEST, _GUESTS = 61184, 4336


def advice_for_root() -> str:
    """What to tell somebody who grades as root; empty for everybody else."""
    if os.geteuid():
        return ""
    return "you are grading as root. Use an ordinary account, where isolation is stronger: course_kit/grading/LIMITS.md"


def guest_user(worker: int) -> int:
    """The number of a user for the submissions of a worker process, where the grader is root."""
    return _FIRST_GUEST + worker % _GUESTS


def begin_trial(*, with_guest: bool = True) -> Callable[[], Isolation]:
    """Have a child process set up each kind, of a process with one thread; call what is returned once: it waits."""
    root = os.geteuid() == 0
    user = guest_user(os.getpid()) if root and with_guest else 0
    reader, writer = os.pipe()
    folder = tempfile.TemporaryDirectory(prefix="course-kit-")
    child = fork_child(partial(_try_each, writer, folder.name, user))
    os.close(writer)

    def wait_for_outcome() -> Isolation:
        with os.fdopen(reader) as lines:  # one for each kind that works, and reasons after "!"
            answers = [line.rstrip("\n") for line in lines]
        os.waitpid(child, 0)
        folder.cleanup()
        if user and "network" not in answers:  # as root of a container that may not map a second user
            alone = begin_trial(with_guest=False)()
            if alone.network:
                return alone
        reasons = "; ".join(dict.fromkeys(line[1:].strip() for line in answers if line.startswith("!")))
        kinds = {name: name in answers for name in ("network", "processes", "files", "landlock", "syscalls", "user")}
        return Isolation(**kinds, root=root, reason=reasons)

    return wait_for_outcome


def _try_each(writer: int, folder: str, user: int) -> None:
    if file_view.landlock_version():
        os.write(writer, b"landlock\n")
    has_network = _works(writer, "network", lambda: namespaces.enter_network(user))
    has_processes = has_network and _works(writer, "processes", lambda: namespaces.enter_processes(user))

    def try_inside() -> None:
        if has_processes:
            _works(writer, "files", lambda: file_view.lay_out(file_view.find_view(), folder, 1, user))
        if user:
            _works(writer, "user", lambda: _try_user(user))
        _works(writer, "syscalls", seccomp.install)

    os.waitpid(fork_child(try_inside), 0)


def _try_user(user: int) -> None:
    """Raise OSError if that user could not read what every submission needs."""
    namespaces.become(user)
    for path in (sys.executable, os.__file__, file_view.ROBOT):
        os.close(os.open(path, os.O_RDONLY))


def _works(writer: int, name: str, build: Callable[[], None]) -> bool:
    answer = name
    try:
        build()
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        answer = f"! {_REASONS.get(problem.errno or 0, '')}{problem.strerror or problem}{where}"
    os.write(writer, answer.replace("\n", " ").encode() + b"\n")
    return answer == name
