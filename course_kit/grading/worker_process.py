"""The warm process behind a `Worker` or several: everything imported, nothing initialised, a fork for each submission.

It never calls rclpy.init itself: a process that has cannot be forked any more.
"""

from __future__ import annotations

import gc
import os
import select
import signal
import socket
import sys
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.grading import isolation, namespaces, probing, processes, scratch
from course_kit.grading.job import Job
from course_kit.grading.warden import Warden
from course_kit.grading.wire import Channel, ChannelClosedError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.isolation import Isolation

_FIRST_SERVED = -19  # nice value


def serve(channels: Sequence[Channel], exercises: Sequence[str]) -> None:
    """The process: get warm, then grade job after job until the other ends close.

    Args:
        channels: the line to each worker. A single worker is this process; of several each is a fork of it.
        exercises: whose graders are loaded beforehand.
    """
    usual = os.getpriority(os.PRIO_PROCESS, 0)
    with suppress(OSError):
        # Root only, whom the kernel's limit on processes does not hold: the guard has to get a turn in a fork bomb.
        os.setpriority(os.PRIO_PROCESS, 0, _FIRST_SERVED)
    namespaces.adopt_orphans()
    found = isolation.try_out()
    probing.warm_up()
    for exercise in exercises:
        _load(exercise)
    gc.freeze()  # keeps the forks from copying what they only look at
    if len(channels) == 1:
        _work(channels[0], found, usual)
        return
    children = [_fork_worker(channel, channels, found, usual) for channel in channels]
    for channel in channels:
        channel.close()
    for child in children:  # not reaped: while this process lives, no other one gets the number of a fork
        os.waitid(os.P_PID, child, os.WEXITED | os.WNOWAIT)
    processes.end_descendants()


def _fork_worker(channel: Channel, channels: Sequence[Channel], found: Isolation, usual: int) -> int:
    child = os.fork()
    if child:
        return child
    status = 1
    try:
        os.setsid()  # Linux shares a busy machine out among sessions; each worker is to have its part
        namespaces.die_with_parent()
        namespaces.adopt_orphans()
        for other in channels:
            if other is not channel:
                other.close()  # else nobody would notice the end of that worker
        with suppress(ChannelClosedError):
            _work(channel, found, usual)
        status = 0
    except BaseException:  # noqa: BLE001 - a fork must not go on in its parent's code; the file of last words has it
        sys.excepthook(*sys.exc_info())
    finally:
        os._exit(status)


def _work(channel: Channel, found: Isolation, usual: int) -> None:
    """One worker: it ends with ChannelClosedError."""
    folder = scratch.make()
    os.environ["ROS_LOG_DIR"] = str(folder)  # of the probe, which logs nothing
    try:
        channel.send({"isolation": found.to_mapping(), "process": os.getpid()})
        while True:
            job = Job.from_mapping(channel.receive()["job"])
            job = replace(job, isolation=found, priority=usual, scratch=str(folder))
            _load(job.exercise)
            outcome = _grade(job, channel)
            scratch.clear(folder)
            channel.send(outcome)
    finally:
        scratch.remove(folder)


def _load(exercise: str) -> None:
    with suppress(Exception):  # the probe meets it again, and says what is wrong with the grader
        probing.load(exercise)


def _grade(job: Job, channel: Channel) -> dict[str, Any]:
    ours, theirs = Channel.pair()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            ours.close()
            theirs.send(Warden(job).run())
            status = 0
        except BaseException:  # noqa: BLE001 - a fork must not go on in its parent's code; the worker reports it
            sys.excepthook(*sys.exc_info())
        finally:
            os._exit(status)
    theirs.close()
    try:
        return _outcome(ours, channel)
    finally:
        ours.close()
        processes.end_descendants()


def _outcome(warden: Channel, parent: Channel) -> dict[str, Any]:
    poll = select.poll()
    poll.register(warden.fileno(), select.POLLIN)
    poll.register(parent.fileno(), select.POLLIN)
    ready = [descriptor for descriptor, _ in poll.poll()]
    if parent.fileno() in ready:
        raise ChannelClosedError("the parent has gone, or speaks out of turn")
    try:
        return warden.receive()
    except ChannelClosedError:
        return {"results": [], "stdout": "", "stderr": "", "problem": "the grader's warden was killed", "timings": {}}


def _main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then closes the channel
    descriptors, *exercises = sys.argv[1:]
    channels = [Channel(socket.socket(fileno=int(number))) for number in descriptors.split(",")]
    try:
        serve(channels, exercises)
    except ChannelClosedError:
        pass
    except Exception as problem:  # noqa: BLE001 - the parent tells a person
        for channel in channels:
            with suppress(ChannelClosedError):
                channel.send({"problem": f"The grader could not start: {problem}"})


if __name__ == "__main__":
    _main()
