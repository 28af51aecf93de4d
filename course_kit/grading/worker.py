"""A warm process that grades one submission after another.

Importing rclpy and loading a service type takes ten times as long as checking a submission, so a worker does it
once and forks. Several workers grade side by side. This is the handle in the trusted parent; the process itself is
`worker_process`.
"""

from __future__ import annotations

import socket
import subprocess
import sys
import tempfile
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.wire import Channel, ChannelClosedError

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Self

    from course_kit.grading.job import Job

_START_S = 60.0  # importing everything from a cold disk on a loaded machine
_GRACE_S = 60.0  # beyond the wall time; a worker that is later than that hangs, by a fault of ours
_STOP_S = 5.0
# Python 3.12 warns of forks beside other threads; those of the tracing library take no lock of ours.
_FORKS_ARE_MEANT = "ignore:This process:DeprecationWarning"
# What a program needs to run ROS; everything else, tokens among it, stays out of a submission's reach.
_PASSED_ON = ("LANG", "LANGUAGE", "TZ", "PATH", "VIRTUAL_ENV", "LD_LIBRARY_PATH", "HOME", "TMPDIR", "XDG_STATE_HOME")
_PASSED_ON_PREFIXES = (
    "LC_",
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
)


class Worker:
    """A worker process. Start many ahead of time; each takes one job at a time, from one thread at a time."""

    def __init__(self, *, whole_environment: bool = False, own_graph: bool = True) -> None:
        """Start the process; it gets ready while the caller goes on.

        Args:
            whole_environment: pass on all variables, for commands of the user's own.
            own_graph: False to grade nodes on the graph this environment belongs to.
        """
        ours, theirs = socket.socketpair()
        self._said = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the worker; a pipe nobody reads would fill up
        with theirs:
            self._process = subprocess.Popen(
                [
                    sys.executable,
                    "-W",
                    _FORKS_ARE_MEANT,
                    "-m",
                    "course_kit.grading.worker_process",
                    str(theirs.fileno()),
                ],
                env=_environment(whole=whole_environment, own_graph=own_graph),
                stdin=subprocess.DEVNULL,
                stdout=self._said,
                stderr=subprocess.STDOUT,
                pass_fds=[theirs.fileno()],
                start_new_session=True,
            )
        self._channel = Channel(ours)
        self._closing = False
        self._greeting: dict[str, Any] | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def process_id(self) -> int:
        """Of the worker process."""
        return self._process.pid

    def ready(self) -> dict[str, Any]:
        """Wait until it can take a job; returns the isolation it has found.

        Raises:
            GradingError: it did not start.
        """
        if self._greeting is None:
            try:
                self._greeting = self._channel.receive(_START_S)
            except (ChannelClosedError, TimeoutError) as problem:
                raise GradingError(f"The grader could not start. {self._last_words()}") from problem
        if problem_text := self._greeting.get("problem"):
            raise GradingError(str(problem_text))
        return dict(self._greeting["isolation"])

    def grade(self, job: Job) -> dict[str, Any]:
        """Grade one submission; returns the outcome as `Warden.run` describes it.

        Raises:
            GradingError: the worker ended or hung; it can take no further job then.
        """
        self.ready()
        try:
            self._channel.send({"job": job.to_mapping()})
            return self._channel.receive(job.limits.wall_s + _GRACE_S)
        except (ChannelClosedError, TimeoutError) as problem:
            raise GradingError(f"The grader ended while it was at work. {self._last_words()}") from problem

    def close(self) -> None:
        """End the process and everything it has started."""
        self._closing = True
        self._channel.hang_up()  # it notices, ends what it has under way, and stops
        try:
            self._process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._said.close()

    def _last_words(self) -> str:
        """What the process has printed, when it has ended; it prints nothing as long as all is well."""
        try:
            status = self._process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            status = self._process.wait()
        if self._closing:
            return "It was closed meanwhile."
        self._said.seek(0)
        lines = self._said.read().decode("utf-8", errors="replace").strip().splitlines()
        return lines[-1] if lines else f"Its exit status was {status}."


def _environment(*, whole: bool, own_graph: bool) -> dict[str, str]:
    variables = environment.child_environment(
        PYTHONDONTWRITEBYTECODE="1", PYTHONUNBUFFERED=None, OPENBLAS_NUM_THREADS="1", ROS_PYTHON_CHECK_FIELDS="1"
    )
    if own_graph:
        variables["ROS_DOMAIN_ID"] = "0"  # never joined: each grading has its own, and the worker needs no lease
        for name in _OTHER_GRAPHS:
            variables.pop(name, None)
        if variables.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps"):
            # SYSTEM_DEFAULT has rmw_fastrtps leave the transports to the profile, which allows loopback only; with
            # LOCALHOST it would bring back shared memory.
            variables.update(
                ROS_AUTOMATIC_DISCOVERY_RANGE="SYSTEM_DEFAULT",
                FASTRTPS_DEFAULT_PROFILES_FILE=str(environment.LOOPBACK_PROFILE),
            )
        else:
            variables["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    if whole:
        return variables
    return {
        name: value for name, value in variables.items() if name in _PASSED_ON or name.startswith(_PASSED_ON_PREFIXES)
    }
