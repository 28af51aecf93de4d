"""The warm process behind a `Worker`: everything imported, nothing initialised, one fork for each submission.

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
    from pathlib import Path

_FIRST_SERVED = -19  # nice value


def serve(channel: Channel) -> None:
    """The process: get warm, then grade job after job until the other end closes."""
    folder = scratch.make()
    try:
        _serve(channel, folder)
    finally:
        scratch.remove(folder)


def _serve(channel: Channel, folder: Path) -> None:
    os.environ["ROS_LOG_DIR"] = str(folder)  # of the probe, which logs nothing
    usual = os.getpriority(os.PRIO_PROCESS, 0)
    with suppress(OSError):
        # Root only, whom the kernel's limit on processes does not hold: the guard has to get a turn in a fork bomb.
        os.setpriority(os.PRIO_PROCESS, 0, _FIRST_SERVED)
    namespaces.adopt_orphans()
    found = isolation.try_out()
    probing.warm_up()
    gc.freeze()  # keeps the forks from copying what they only look at
    channel.send({"isolation": found.to_mapping()})
    while True:
        job = Job.from_mapping(channel.receive()["job"])
        job = replace(job, isolation=found, priority=usual, scratch=str(folder))
        with suppress(Exception):  # the probe meets it again, and says what is wrong with the grader
            probing.load(job.exercise)
        outcome = _grade(job, channel)
        scratch.clear(folder)
        channel.send(outcome)


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
    channel = Channel(socket.socket(fileno=int(sys.argv[1])))
    try:
        serve(channel)
    except ChannelClosedError:
        pass
    except Exception as problem:  # noqa: BLE001 - the parent tells a person
        with suppress(ChannelClosedError):
            channel.send({"problem": f"The grader could not start: {problem}"})


if __name__ == "__main__":
    _main()
