"""The warm process behind a `Worker` or several: everything imported, nothing initialised, a fork for each submission.

It never calls rclpy.init itself: a process that has can no longer be forked.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import tempfile
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from course_kit.grading.checks.check import choose_part, run_all
from course_kit.grading.checks.context import CheckContext
from course_kit.grading.errors import GradingError
from course_kit.grading.model import limits
from course_kit.grading.model.job import Job
from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.sandbox import file_view, isolation, launcher, machine, namespaces, needs
from course_kit.grading.sandbox.launcher import Launcher
from course_kit.grading.sandbox.supervisor import GivenUpError, Supervisor, enter_own_network
from course_kit.grading.workers import exercise_job
from course_kit.process.channel import Channel, ChannelClosedError
from course_kit.process.child import BOUND_AT_ONCE, fork_child, freeze_memory
from course_kit.process.libc import adopt_orphans, die_with_parent, set_name

if TYPE_CHECKING:
    from collections.abc import Callable
    from mmap import mmap

    from course_kit.grading.model.job import GradingOutcome, Isolation
    from course_kit.grading.sandbox.file_view import FileView

_OF_EVERY_NODE = (
    *("type_description_interfaces/srv/GetTypeDescription", "rcl_interfaces/msg/ParameterEvent"),
    *("rcl_interfaces/srv/DescribeParameters", "rcl_interfaces/srv/GetParameters", "rcl_interfaces/srv/ListParameters"),
    *("rcl_interfaces/srv/GetParameterTypes", "rcl_interfaces/srv/SetParameters"),
    "rcl_interfaces/srv/SetParametersAtomically",
)
_TRIES = 3  # more than one for what may be no fault of the submission, such as a process that somebody has killed


def main() -> None:
    """The process: get warm, then grade job after job until the other ends of its channels close.

    Its arguments are their descriptors, comma-separated, and interfaces to load for all. Why it could not start is what
    it prints last.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then closes the channels
    for name in BOUND_AT_ONCE:  # the linker has read it; what this process starts binds as usual
        os.environ.pop(name, None)
    channels = [Channel(socket.socket(fileno=int(number))) for number in sys.argv[1].split(",")]
    set_name("grade warm")
    namespaces.forbid_tracing()
    adopt_orphans()
    wait_for_outcome = isolation.begin_trial()
    try:
        warm_up()
        launcher.load_interfaces(sys.argv[2:])
    finally:
        found = wait_for_outcome()
    view = file_view.find_view()
    freeze_memory()
    while channels:
        channel = channels.pop()
        starter = Launcher()
        _fork(partial(launcher.serve, starter.other_end, sys.argv[2:]), *channels, channel, starter)
        _fork(partial(_work, channel, starter, found, view), *channels, starter.other_end)
        for end in (channel, starter, starter.other_end):
            end.close()
    with suppress(ChildProcessError):
        while True:
            os.wait()


def _fork(run: Callable[[], None], *others: Channel | Launcher | socket.socket) -> None:
    """Fork; the child holds none of the ends of others, else nobody would notice that one of those ends."""

    def run_apart() -> None:
        die_with_parent()
        for end in others:
            end.close()
        run()

    fork_child(run_apart)


def _work(channel: Channel, starter: Launcher, found: Isolation, view: FileView) -> None:
    """A worker, which is a fork of this process: grade job after job, until the other end closes."""
    os.setsid()  # Linux shares a busy machine out among sessions; each worker is to have its part
    adopt_orphans()
    set_name("grade worker")
    user = isolation.guest_user(os.getpid()) if found.user else 0
    network: tuple[int, ...] = ()
    with (
        suppress(ChannelClosedError, GivenUpError),
        tempfile.TemporaryDirectory(prefix="course-kit-worker-", ignore_cleanup_errors=True) as folder,
    ):
        os.chmod(folder, 0o711)  # noqa: PTH101, S103 - a submission with its own user finds its directory in it
        os.environ["ROS_LOG_DIR"] = folder  # of the grader process, which logs nothing
        channel.send({"isolation": found, "process": os.getpid()})
        while True:
            job = convert_record(channel.receive()["job"], Job)
            job = replace(job, isolation=found, scratch=folder, user=user)
            if not job.interfaces:
                with suppress(Exception):  # the grader process meets it again, and says what is wrong with the grader
                    exercise_job.load_grader(job)
            if found.network and job.mode != "attach" and not network:
                network = enter_own_network(user)
            for _ in range(_TRIES):
                outcome = _grade(job, channel, starter, view, network)
                if not outcome["again"]:
                    break
            channel.send(outcome)


def _grade(job: Job, channel: Channel, starter: Launcher, view: FileView, network: tuple[int, ...]) -> GradingOutcome:
    problem = next(needs.describe_lacks(job.limits, guest=job.user != 0), "")
    try:
        if not problem:
            return Supervisor(job, starter, view, network, channel).run(run_checks)
    except OSError as failure:  # the machine has run out of something
        problem = f"the submission could not be run: {failure}"
    return {"results": [], "stdout": "", "stderr": "", "problem": problem, "again": False}


def warm_up() -> None:
    """Import what every grading needs. Must not initialise ROS: a context does not survive a fork."""
    import rclpy.action
    import rclpy.executors
    import rclpy.node

    import course_kit.grading.checks.grader_node
    import course_kit.grading.checks.vocabulary

    machine.processor_share()
    launcher.load_interfaces(_OF_EVERY_NODE)  # else each submission loads them when its node is made
    del rclpy, course_kit


def run_checks(supervisor: Channel, job: Job, lives: mmap) -> None:
    """The grader process: join the graph, run the checks of an exercise, report each as it is known."""
    set_name("grade grader")
    limits.bound_reader(job.limits.wall_s)
    problem = ""
    try:
        grader = exercise_job.load_grader(job)
        context = CheckContext(supervisor, job, getattr(grader, "VARIABLES", {}), lives)
        checks = exercise_job.checks_of_grader(grader, job)
        if job.only:
            checks = choose_part(checks, job.only)
        if not (job.text.problem or job.variable or job.text.files):
            context.launch()
        try:
            for result in run_all(checks, context):
                supervisor.send({"do": "result", "result": result})
                if job.first_failure and result.status == "failed" and result.max_points:
                    break
        finally:
            if not job.isolation.network:  # our own graph ends with us, at once; others wait for those who do not leave
                context.close()
    except ChannelClosedError:
        return
    except GradingError as fault:
        problem = str(fault)
    except Exception as fault:  # noqa: BLE001 - a broken grader or installation; the report says so
        problem = f"{type(fault).__name__}: {fault}"
    supervisor.send({"do": "done", "problem": problem})
