"""A warm process that grades one submission after another: the handle in the trusted parent; see `worker_process`.

Importing rclpy takes ten times as long as checking a submission. So one process gets warm, and as many workers as
wanted are forked from it, which share that cost, and their pages in memory as well.
"""

from __future__ import annotations

import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING, cast

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model.job import Isolation
from course_kit.process import Closable
from course_kit.process.channel import Channel, ChannelClosedError
from course_kit.process.child import BOUND_AT_ONCE, QuietChild

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.job import GradingOutcome, Job
    from course_kit.grading.model.plain_data import Record

_START_S = 60.0  # importing everything from a cold disk on a loaded machine
_GRACE_S = 60.0  # beyond the wall time; a worker that is later than that hangs, by a fault of ours
_STOP_S = 5.0
_DYING_S = 0.5
# Python 3.12 warns of forks beside other threads; those of the tracing library take no lock of ours.
_FORKS_ARE_MEANT = "ignore:This process:DeprecationWarning"
# What a program needs to run ROS; everything else, tokens among it, stays out of a submission's reach.
_PASSED_ON = (
    *("TZ", "PATH", "VIRTUAL_ENV", "LD_LIBRARY_PATH", *BOUND_AT_ONCE),
    *("HOME", "TMPDIR", "XDG_STATE_HOME", "OPENBLAS_NUM_THREADS"),
)
_PASSED_ON_PREFIXES = (
    *("LANG", "LC_", "LOCPATH"),  # names of files mean the same folders to a worker as to whoever asks it
    *("PYTHON", "ROS", "_ROS", "RMW_", "RCUTILS_", "FAST", "CYCLONEDDS_", "AMENT_", "COLCON_", "CONDA_", "COURSE_KIT_"),
)
_OTHER_GRAPHS = (
    *("ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY", "ROS_DISCOVERY_SERVER", "ROS_SUPER_CLIENT"),
    *("COURSE_KIT_DOMAIN_ID", "ROS_SECURITY_ENABLE", "RCL_ASSERT_RMW_ID_MATCHES"),
)


class WarmProcess(QuietChild):
    """The process, seen from the trusted parent."""

    def __init__(
        self, workers: int = 1, interfaces: Iterable[str] = (), *, whole: bool = False, own_graph: bool = True
    ) -> None:
        """Start the process; it gets ready while the caller goes on, and loads these interfaces for all workers."""
        ours, theirs = zip(*(socket.socketpair() for _ in range(workers)), strict=True)
        self.channels = [Channel(end) for end in ours]
        descriptors = [end.fileno() for end in theirs]
        python, *call = environment.trusted_python("course_kit.grading.workers.worker_process", "main")
        try:
            command = [python, "-W", _FORKS_ARE_MEANT, *call, ",".join(map(str, descriptors)), *interfaces]
            super().__init__(command, descriptors, variables_of(whole=whole, own_graph=own_graph))
        finally:
            for end in theirs:
                end.close()


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
        # A grade does not depend on the user's middleware: the types of the exercises need Fast DDS. SYSTEM_DEFAULT
        # has it leave the transports to the profile, which allows loopback only; LOCALHOST would bring back shared
        # memory.
        changes |= {
            **dict.fromkeys(_OTHER_GRAPHS),
            "ROS_DOMAIN_ID": "0",  # never joined: each grading has its own, and the worker needs no lease
            "RMW_IMPLEMENTATION": environment.middleware.SUPPORTED,
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
            environment.middleware.PROFILE_VARIABLE: str(environment.LOOPBACK_PROFILE),
        }
    variables = environment.child_environment(**changes)
    if whole:
        return variables
    return {
        name: value for name, value in variables.items() if name in _PASSED_ON or name.startswith(_PASSED_ON_PREFIXES)
    }


class Worker(Closable):
    """A worker process. Start many ahead of time; each takes one job at a time, from one thread at a time."""

    def __init__(self, process: WarmProcess | None = None, number: int = 0) -> None:
        """Make it one of a warm process, else of a new one, which gets ready while the caller goes on."""
        self._process = process or WarmProcess()
        self._channel = self._process.channels[number]
        self._greeting: Record | None = None

    @property
    def process_id(self) -> int:
        """Of the worker process."""
        self.ready()
        return int((self._greeting or {})["process"])

    def ready(self) -> Isolation:
        """Wait until it can take a job; returns the isolation it has found."""
        if self._greeting is None:
            with self._explain_end("could not start"):
                self._greeting = self._channel.receive(_START_S)
        return Isolation(**self._greeting["isolation"])

    def send(self, job: Job) -> None:
        """Have it grade one submission; `receive` waits for what comes of it."""
        self.ready()
        with self._explain_end("ended while it was grading"):
            self._channel.send({"job": job})

    def receive(self, job: Job) -> GradingOutcome:
        """Wait until the job that was sent is done; returns the outcome as the supervisor describes it."""
        with self._explain_end("ended while it was grading"):
            return cast("GradingOutcome", self._channel.receive(job.limits.wall_s + _GRACE_S))

    @contextmanager
    def _explain_end(self, what: str) -> Iterator[None]:
        try:
            yield
        except (ChannelClosedError, TimeoutError) as problem:
            self._process.wait(_DYING_S)  # when it was killed its forks end a little earlier than itself
            why = self._process.last_line() or "It hung, or another program has ended it."
            raise GradingError(f"The grader {what}. {why}") from problem

    def has_ended(self) -> bool:
        """Whether its process has gone, for one that is not at work."""
        return self._process.exit_code() is not None or self._channel.is_closed()

    def close(self) -> None:
        """End the process and everything it has started; one of several ends with the last of them at the latest."""
        self._channel.hang_up()  # it notices, ends what it has under way, and stops
        if all(channel.is_closed() for channel in self._process.channels):
            self._process.wait_or_kill(_STOP_S)  # the forks die with it


def isolation_status() -> Isolation:
    """What isolates submissions on this machine, as a worker has found; nothing where it cannot even start."""
    try:
        with Worker() as worker:
            return worker.ready()
    except GradingError as problem:
        return Isolation(reason=f"trying it out failed ({problem})")


def start_workers(number: int, exercises: Iterable[Exercise] = ()) -> list[Worker]:
    """Start several workers that share the cost of getting warm, and of loading what these exercises need of ROS."""
    interfaces = {end.type for exercise in exercises if not exercise.interfaces for end in exercise.endpoints}
    process = WarmProcess(number, interfaces)
    return [Worker(process, each) for each in range(number)]
