"""The operating system's side of workers: one process that gets warm, and as many workers as wanted forked from it.

Importing everything costs half a second of computing. So workers that are started together share it, and their pages
in memory as well.
"""

from __future__ import annotations

import os
import signal
import socket
import threading
from contextlib import suppress
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading.sandbox.channel import Channel
from course_kit.process.child import INTO_STDOUT, Child
from course_kit.process.fork import BOUND_AT_ONCE
from course_kit.process.output import LastWords

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_STOP_S = 5.0
_DYING_S = 0.5
# Python 3.12 warns of forks beside other threads; those of the tracing library take no lock of ours.
_FORKS_ARE_MEANT = "ignore:This process:DeprecationWarning"
# What a program needs to run ROS; everything else, tokens among it, stays out of a submission's reach.
_PASSED_ON = (
    "TZ",
    "PATH",
    "VIRTUAL_ENV",
    "LD_LIBRARY_PATH",
    *BOUND_AT_ONCE,
    "HOME",
    "TMPDIR",
    "XDG_STATE_HOME",
    "OPENBLAS_NUM_THREADS",
)
_PASSED_ON_PREFIXES = (
    "LANG",  # with the next two: names of files mean the same folders to a worker as to whoever asks it
    "LC_",
    "LOCPATH",
    "PYTHON",
    "ROS",
    "_ROS",
    "RMW_",
    "RCUTILS_",
    "FAST",
    "CYCLONEDDS_",
    "AMENT_",
    "COLCON_",
    "CONDA_",
    "COURSE_KIT_",
)
_OTHER_GRAPHS = (
    "ROS_STATIC_PEERS",
    "ROS_LOCALHOST_ONLY",
    "ROS_DISCOVERY_SERVER",
    "ROS_SUPER_CLIENT",
    "COURSE_KIT_DOMAIN_ID",
    "ROS_SECURITY_ENABLE",
    "RCL_ASSERT_RMW_ID_MATCHES",
)


class WarmProcess:
    """The process, seen from the trusted parent."""

    def __init__(self, workers: int, variables: Mapping[str, str], graders: Sequence[str] = ()) -> None:
        """Start the process; it gets ready while the caller goes on."""
        pairs = [socket.socketpair() for _ in range(workers)]
        self.channels = [Channel(ours) for ours, _ in pairs]
        theirs = [end for _, end in pairs]
        self._said = LastWords()
        descriptors = [end.fileno() for end in theirs]
        python, *call = environment.trusted_python("course_kit.grading.workers.worker_process", "main")
        try:
            self._process = Child(
                [python, "-W", _FORKS_ARE_MEANT, *call, ",".join(map(str, descriptors)), *graders],
                folder="/",
                environ=variables,
                stdout=self._said.file,
                stderr=INTO_STDOUT,
                descriptors=descriptors,
            )
        finally:
            for end in theirs:
                end.close()
        self._shared = workers > 1
        self._lock = threading.Lock()
        self._using = workers

    def leave(self) -> None:
        """Say that one more worker has hung up; with the last one the process ends, with everything it has started."""
        with self._lock:
            self._using -= 1
            if self._using:
                return
        self._process.wait_or_kill(_STOP_S)  # the forks die with it
        self._said.file.close()

    def give_up(self, worker: int | None) -> str:
        """End a worker that has stopped working; returns what was printed last, or how it has ended."""
        if not self._shared:
            code = self._process.wait_or_kill(_STOP_S)
            return self._said.last_line() or f"Its exit status was {code}."
        ended = self._process.wait(_DYING_S)  # when it was killed its forks end a little earlier than itself
        # As long as the warm process lives its forks are not reaped, and no other process gets their numbers.
        if worker is not None and ended is None:
            with suppress(ProcessLookupError):
                os.kill(worker, signal.SIGKILL)
        return self._said.last_line() or "It hung, or another program has ended it."

    def has_ended(self) -> bool:
        """Whether it has gone, and all workers with it."""
        return self._process.exit_code() is not None


def variables_of(*, whole: bool, own_graph: bool) -> dict[str, str]:
    """The environment of a worker."""
    changes: dict[str, str | None] = {
        "PYTHONUNBUFFERED": None,
        "PYTHON_COLORS": "0",  # where FORCE_COLOR is set, Python 3.13 colours tracebacks, and they could not be read
        "OPENBLAS_NUM_THREADS": "1",
        "ROS_PYTHON_CHECK_FIELDS": "1",
        **BOUND_AT_ONCE,
    }
    if own_graph:
        changes["ROS_DOMAIN_ID"] = "0"  # never joined: each grading has its own, and the worker needs no lease
    variables = environment.child_environment(**changes)
    if own_graph:
        for name in _OTHER_GRAPHS:
            variables.pop(name, None)
        # A grade does not depend on the user's middleware: the types of the exercises need Fast DDS. SYSTEM_DEFAULT
        # has it leave the transports to the profile, which allows loopback only; LOCALHOST would bring back shared
        # memory.
        variables.update(
            {
                "RMW_IMPLEMENTATION": environment.middleware.SUPPORTED,
                "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
                environment.middleware.PROFILE_VARIABLE: str(environment.LOOPBACK_PROFILE),
            }
        )
    if whole:
        return variables
    return {
        name: value for name, value in variables.items() if name in _PASSED_ON or name.startswith(_PASSED_ON_PREFIXES)
    }
