"""Runs one grading: the network around it, the grader process and the submission in it, and what passes between them.

The work of a worker, with one thread and one loop. It obeys the grader process, never the submission.
"""

from __future__ import annotations

import mmap
import os
import select
import shutil
import signal
import socket
import tempfile
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading.sandbox import init_process, machine, namespaces
from course_kit.grading.sandbox.output_collector import BoundedOutput, OutputCollector
from course_kit.grading.sandbox.start_order import Streams, make_start_order
from course_kit.process import tree
from course_kit.process.channel import Channel, ChannelClosedError
from course_kit.process.child import fork_child
from course_kit.process.libc import die_with_parent

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.model.job import GradingOutcome, Job
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.sandbox.file_view import FileView
    from course_kit.grading.sandbox.launcher import Launcher

_ANSWER_S = 5.0  # how long the init process is waited for; it has answered long before, unless the machine is very busy
_FIRST_S = 25.0  # the same after a start: on a busy machine a sandbox takes seconds to be made
_QUIET_S = 0.04  # nothing more is coming when nothing came for so long
_DUMP_S = 3.0  # how long a dump of stacks is waited for: a submission may have turned it off
_PROFILE = environment.middleware.PROFILE_VARIABLE
_NO_DOMAIN = "no ROS domain is free: courses and graders on this machine use all. Close some, then grade again"


class GivenUpError(Exception):
    """Whoever has asked for the grading has gone, or sent a message out of turn."""


class _BrokenOffError(Exception):
    """The grading cannot go on, by no fault of the submission; the text says why."""


def enter_own_network(user: int) -> tuple[int, ...]:
    """Put this process into a network with nothing but loopback; descriptors of the namespaces, for others to join.

    Gradings take place there one after the other, and nothing of one lives when the next begins.
    """
    namespaces.enter_network(user)
    die_with_parent()  # entering a user namespace has cleared it
    if os.environ[_PROFILE] == str(environment.LOOPBACK_PROFILE):
        os.environ[_PROFILE] = str(environment.PRIVATE_NETWORK_PROFILE)
    return tuple(os.open(f"/proc/self/ns/{kind}", os.O_RDONLY) for kind in ("user", "net"))


class Supervisor:
    """The master of one grading."""

    def __init__(self, job: Job, launcher: Launcher, view: FileView, network: tuple[int, ...], parent: Channel) -> None:
        """Prepare a grading, in the machine's network or another; it is given up when `parent` hangs up."""
        self._job = job
        self._launcher = launcher
        self._view = view
        self._network = network
        self._parent = parent
        self._deadline = time.monotonic() + job.limits.wall_s
        self._totals = (BoundedOutput(), BoundedOutput())
        self._folder = ""  # the scratch directory of what runs; empty while nothing does
        self._collector = OutputCollector(Streams(*[-1] * 5), self._totals)  # of what was started last
        self._lives = mmap.mmap(-1, 1)  # 1 while it does; shared with the grader: a question costs both
        self._domains = ExitStack()
        self._launches = 0
        self._arguments: tuple[str, ...] = ()
        self._results: list[Record] = []
        self._fault = ""
        self._killed_before = machine.count_oom_kills()
        self._again = False  # whether this may go better the next time: something was killed that should not be

    def run(self, run_grader: Callable[[Channel, Job, mmap.mmap], None]) -> GradingOutcome:
        """Grade, with the checks run by `run_grader` in another process; nothing that was started lives after it."""
        ours, theirs = map(Channel, socket.socketpair())

        def run_it() -> None:
            ours.close()
            die_with_parent()
            run_grader(theirs, self._job, self._lives)

        try:
            fork_child(run_it)
            theirs.close()
            problem = self._serve(ours)
        finally:
            try:
                self._stop()
            finally:
                self._domains.close()
                tree.end_descendants()
        return {
            "results": self._results,
            "stdout": self._totals[0].text(),
            "stderr": self._totals[1].text(),
            "problem": problem or self._fault,
            "again": self._again,
        }

    def _serve(self, grader_process: Channel) -> str:
        """Obey the grader's process until it is done; returns why the grading came to no end, or nothing."""
        try:
            while True:
                self._look_after_everything()
                if not self._pump(0.25, grader_process):
                    continue
                message = grader_process.receive(_ANSWER_S)
                if message["do"] == "done":
                    return str(message["problem"])
                answer = self._obey(message)
                if answer is not None:
                    grader_process.send(answer)
        except environment.DomainError as lack:
            return _NO_DOMAIN if isinstance(lack, environment.NoDomainError) else str(lack)
        except _BrokenOffError as broken:
            problem = str(broken)
        except (ChannelClosedError, TimeoutError) as gone:
            problem = f"the grader's own process ended unexpectedly ({gone})"
        except OSError as lack:  # the machine has run out of something
            problem = f"the submission could not be started: {lack}"
        self._again = True
        return problem

    def _look_after_everything(self) -> None:
        """End a submission whose time is up."""
        if fault := self._collector.known.get("problem"):  # of the sandbox itself
            raise _BrokenOffError(fault)
        if time.monotonic() > self._deadline and not self._collector.over:
            self._end_submission("time")

    def _obey(self, message: Record) -> Record | None:
        what = message["do"]
        if what == "result":
            self._results.append(message["result"])
            return None
        if what == "launch":
            return self._launch(message)
        if what == "stacks":
            return {"stacks": self._stacks(message["program"].encode())}
        if what == "time is up":
            self._end_submission("time")
        elif what == "finish":
            self._pump_until(lambda: False, min(time.monotonic() + message["seconds"], self._deadline))
            self._look_after_everything()
        elif what == "facts":
            self._ask(init_process.SAMPLE)
        elif what == "kill":
            self._ask(init_process.KILL + message["program"].encode())
        return self._collector.facts()

    def _launch(self, message: Record) -> Record:
        """Start the submission."""
        self._stop()
        self._arguments = tuple(message["arguments"])
        self._launches += 1
        if self._network:  # nobody else is there
            domain = self._launches
        else:
            self._domains.close()
            domain = self._domains.enter_context(environment.exclusive_domain())
        job = self._job.for_program(message["program"]) if self._job.text.files else self._job
        variables = {_PROFILE: os.environ[_PROFILE], "ROS_DOMAIN_ID": str(domain)}
        self._folder = tempfile.mkdtemp(prefix="course-kit-", dir=job.scratch or None)
        order = make_start_order(job, message, variables, self._view, self._folder)
        if order.user:
            os.chown(self._folder, order.user, order.user)
        pipes = [*(os.pipe() for _ in range(4)), os.pipe()[::-1]]  # the last one, for control, leads inside
        streams, inside = (Streams(*ends) for ends in zip(*pipes, strict=True))
        for descriptor in streams.descriptors():
            os.set_blocking(descriptor, False)
        self._collector = OutputCollector(streams, self._totals)
        try:
            types = [] if job.interfaces else [end.type for end in job.endpoints]  # a program loads those of strangers
            self._launcher.start(order, inside, self._network, types)
        finally:
            inside.close()
        self._lives[0] = True
        return {"domain": domain}

    def _ask(self, what: bytes) -> None:
        before = self._collector.samples
        self._collector.ask(what)
        patience_s = _ANSWER_S if before else _FIRST_S
        self._pump_until(lambda: self._collector.samples > before, time.monotonic() + patience_s)

    def _stacks(self, program: bytes) -> str:
        """What each thread of the program executes, by faulthandler; empty if it is silent."""
        self._collector.forget_stacks()
        size, deadline = self._collector.evidence_bytes, time.monotonic() + _DUMP_S
        self._collector.ask(init_process.STACKS + program)
        self._pump_until(lambda: self._collector.evidence_bytes > size, deadline)
        # Nothing marks a dump's end, and a busy machine may halt it half-way. A second one begins when it is whole.
        self._collector.ask(init_process.STACKS + program)
        self._pump_until(self._collector.has_whole_dump, deadline)
        return self._collector.stacks()

    def _pump_until(self, condition: Callable[[], bool], deadline: float) -> None:
        """Take in what comes until the condition holds, the submission has ended, or it is too late."""
        while not (self._collector.over or condition()) and time.monotonic() < deadline:
            self._pump(_QUIET_S, None)

    def _pump(self, timeout: float, grader_process: Channel | None) -> bool:
        """Take in what the sandbox brings; True when the grader process wants something."""
        poll = select.poll()
        streams = self._collector.open_streams()
        for descriptor in streams:
            poll.register(descriptor, select.POLLIN)
        if grader_process is not None:
            poll.register(grader_process.fileno(), select.POLLIN)
        poll.register(self._parent.fileno(), select.POLLIN)
        asked = False
        for descriptor, _ in poll.poll(timeout * 1000):
            if descriptor == self._parent.fileno():
                raise GivenUpError
            if descriptor in streams:
                self._collector.take(streams[descriptor])
                self._lives[0] = not self._collector.over
            else:
                asked = True
        if self._collector.printed_bytes > self._job.limits.output_kb * 1024 and not self._collector.over:
            self._end_submission("output")
        return asked

    def _end_submission(self, limit: str) -> None:
        self._collector.known.setdefault("limit", limit)
        self._kill()

    def _kill(self) -> None:
        """Kill all that was started; returns when it is dead and its scratch directory gone."""
        if not self._folder:
            return
        try:
            self._launcher.end()
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)
            self._folder = ""
        self._collector.take_the_rest()
        self._lives[0] = False
        self._collector.streams.close()

    def _stop(self) -> None:
        known = self._collector.known
        if known.get("signal") == signal.SIGKILL and "limit" not in known:  # its own, or of a machine without memory
            self._again = True
            if machine.count_oom_kills() != self._killed_before:
                self._fault = "the machine ran out of memory, and Linux killed a process to free some"
        self._kill()
        if self._arguments and self._collector.facts()["stderr"]:
            words = " ".join(self._arguments)  # or a provoked error looks like one of the ordinary run
            self._totals[1].add(f"[Your program printed the lines above when it was started with: {words}]\n".encode())
        self._arguments = ()
