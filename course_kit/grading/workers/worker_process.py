"""The warm process behind a `Worker` or several: everything imported, nothing initialised, a fork for each submission.

It never calls rclpy.init itself: a process that has cannot be forked any more.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from course_kit.grading.model.job import Job
from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.sandbox import file_view, isolation, launcher, namespaces, needs
from course_kit.grading.sandbox.channel import Channel, ChannelClosedError
from course_kit.grading.sandbox.launcher import Launcher, SandboxStartError
from course_kit.grading.sandbox.supervisor import GivenUpError, Network, Supervisor, enter_own_network
from course_kit.grading.workers import grader_module, grader_process
from course_kit.interfaces.sources import PATH_VARIABLE
from course_kit.process.fork import forget_binding, fork_child, freeze_memory
from course_kit.process.libc import adopt_orphans, die_with_parent, set_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.grading.model.job import GradingOutcome, Isolation
    from course_kit.grading.sandbox.file_view import FileView
    from course_kit.grading.workers.grader_module import Grader

_TRIES = 3  # more than one for what may be no fault of the submission, such as a process that somebody has killed
_FIRST_SERVED = -19  # nice value


@dataclass(frozen=True)
class _Common:
    """What holds for all workers of this process."""

    isolation: Isolation  # what isolates submissions
    priority: int  # the nice value they run at
    view: FileView  # the files they see
    # the folder whose interfaces are loaded, of those that exercises bring: only of one, because others may define the
    # same names in another way
    interfaces: str
    # module and name of the interfaces that are loaded where submissions are started
    loaded: frozenset[tuple[str, str]]


def serve(channels: Sequence[Channel], graders: Sequence[str]) -> None:
    """The process: get warm, then grade job after job until the other ends close."""
    set_name("grade warm")
    usual = os.getpriority(os.PRIO_PROCESS, 0)
    with suppress(OSError):
        # Root only, whom the kernel's limit on processes does not hold: the init process needs a turn in a fork bomb.
        os.setpriority(os.PRIO_PROCESS, 0, _FIRST_SERVED)
    namespaces.forbid_tracing()
    adopt_orphans()
    trial = isolation.Trial()
    try:
        grader_process.warm_up()
    finally:
        found = trial.outcome()
    pairs = [Launcher.pair() for _ in channels]
    launchers = [launcher for launcher, _ in pairs]
    names = _fork_launchers(launchers, [end for _, end in pairs], channels)
    brought = {folder for one in graders if (folder := grader_module.interfaces_beside(one))}
    interfaces = "".join(brought) if len(brought) == 1 else ""
    wanted = (one for one in graders if grader_module.interfaces_beside(one) in ("", interfaces))
    loaded = [grader for one in wanted if (grader := _load(one))]
    known = _named(one for grader in loaded for one in grader.INTERFACES)
    names.send(json.dumps([os.environ.get(PATH_VARIABLE, ""), known]).encode())
    names.close()
    common = _Common(found, usual, file_view.view_of_program(), interfaces, frozenset(known))
    freeze_memory()
    for number in range(len(channels)):
        fork_child(partial(_work_apart, number, channels, launchers, common))
    for one in (*channels, *launchers):
        one.close()
    with suppress(ChildProcessError):
        while True:
            os.wait()


def _fork_launchers(
    launchers: Sequence[Launcher], ends: Sequence[socket.socket], channels: Sequence[Channel]
) -> socket.socket:
    """Start the process from which submissions are forked, before anything is loaded that is not for them."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    freeze_memory()

    def serve_launchers() -> None:
        ours.close()
        for one in (*channels, *launchers):
            one.close()
        launcher.serve_all(theirs, ends)

    fork_child(serve_launchers)
    for one in (theirs, *ends):
        one.close()
    return ours


def _named(interfaces: Iterable[type]) -> list[tuple[str, str]]:
    """Module and name of each, for a process that must not load the graders."""
    return sorted({(one.__module__, one.__name__) for one in interfaces})


def _work_apart(number: int, channels: Sequence[Channel], launchers: Sequence[Launcher], common: _Common) -> None:
    """A worker, which is a fork of this process."""
    os.setsid()  # Linux shares a busy machine out among sessions; each worker is to have its part
    die_with_parent()
    adopt_orphans()
    set_name("grade worker")
    for one in (*channels[:number], *channels[number + 1 :], *launchers[:number], *launchers[number + 1 :]):
        one.close()  # else nobody would notice the end of that worker
    with (
        suppress(ChannelClosedError, GivenUpError),
        tempfile.TemporaryDirectory(prefix="course-kit-worker-", ignore_cleanup_errors=True) as folder,
    ):
        os.chmod(folder, 0o711)  # noqa: PTH101, S103 - a submission with its own user finds its directory in it
        os.environ["ROS_LOG_DIR"] = folder  # of the grader process, which logs nothing
        _work(channels[number], launchers[number], common, folder)


def _work(channel: Channel, starter: Launcher, common: _Common, folder: str) -> None:
    """Grade job after job, until ChannelClosedError ends it."""
    found = common.isolation
    user = isolation.guest(os.getpid()) if found.user else 0
    loaded = set(common.loaded)
    network = Network()
    channel.send({"isolation": found, "process": os.getpid()})
    while True:
        job = convert_record(channel.receive()["job"], Job)
        job = replace(job, isolation=found, priority=common.priority, scratch=folder, user=user)
        needed = _prepare(job) if job.interfaces in ("", common.interfaces) else []
        if new := [one for one in needed if one not in loaded]:
            starter.load(new)
            loaded.update(new)
        if found.network and job.mode != "attach" and not network.descriptors:
            network = enter_own_network(user)
        for _ in range(_TRIES):
            outcome = _grade(job, channel, starter, common.view, network)
            if not outcome["again"]:
                break
        channel.send(outcome)


def _load(grader: str) -> Grader | None:
    with suppress(Exception):  # the grader process meets it again, and says what is wrong with the grader
        return grader_module.load(grader)
    return None


def _prepare(job: Job) -> list[tuple[str, str]]:
    """Load what checks a job, and name the interfaces that it needs."""
    with suppress(Exception):  # as above
        return _named(grader_module.interfaces_of(grader_module.load_for(job), job))
    return []


def _grade(job: Job, channel: Channel, starter: Launcher, view: FileView, network: Network) -> GradingOutcome:
    problem = needs.lacking(job.limits, guest=job.user != 0)
    try:
        if not problem:
            return Supervisor(job, starter, view, network, channel).run(grader_process.main)
    except (SandboxStartError, OSError) as failure:  # the machine has run out of something
        problem = f"the submission could not be run: {failure}"
    return {"results": [], "stdout": "", "stderr": "", "problem": problem, "again": False}


def main() -> None:
    """The process; its arguments are the descriptors of its channels, comma-separated, and modules of checks."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then closes the channel
    needs.raise_soft_limits()
    forget_binding()
    descriptors, *graders = sys.argv[1:]
    channels = [Channel(socket.socket(fileno=int(number))) for number in descriptors.split(",")]
    try:
        serve(channels, graders)
    except ChannelClosedError:
        pass
    except Exception as problem:  # noqa: BLE001 - the parent tells a person
        for channel in channels:
            with suppress(ChannelClosedError):
                channel.send({"problem": f"The grader could not start: {problem}"})
