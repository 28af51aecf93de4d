"""The check context of one grading: the grader's own node, and the verbs a check speaks in.

Every wait has a deadline and ends early when the submission has. Runs in the grader process, a process apart from the
submission and from the one that writes the report.
"""

from __future__ import annotations

import random
import time
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed, NotRun
from course_kit.grading.checks.fair_clock import MOST, FairClock, Recent, State, Used
from course_kit.grading.checks.grader_node import GraderNode
from course_kit.grading.diagnosis import exits
from course_kit.grading.model import limits
from course_kit.grading.model.exchange_log import ExchangeLog
from course_kit.grading.model.process_status import ProcessStatus
from course_kit.grading.sandbox import machine, scheduling

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from course_kit.grading.model.job import Job
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.sandbox.channel import Channel

_STEP_S = 0.02  # how often a condition is looked at beside each message: looking costs computing, which others need
GRAPH_STEP_S = 0.01  # the same for what a change of the graph makes true: rclpy has no event for that
_LOST_S = 2.0  # for an answer of a node that no executor runs any more; it may be on its way
_WATCH_S = 0.05  # how often it is asked whether the submission lives, while an answer is waited for
PHASES = ("start", "discovery")  # where time goes beside checking: the program's making, and its way onto the graph
_MOST_OF_A_START = 0.92  # nothing is measured by how long a start takes: on a very busy machine, twelve times as long
_FINISH_S = 0.25  # how often it is asked whether the time is up, while a program's end is waited for
_RPC_S = 30.0  # the supervisor answers in milliseconds; without it there is no grading


class SubmissionEndedError(Failed):
    """The submission's process has ended while something was expected of it; by itself explained as during a call."""

    def __init__(self, process: ProcessStatus, job: Job) -> None:
        diagnosis, message = exits.of_call(process, job)
        super().__init__(Evidence(got="the program has ended"), message, diagnosis)
        self.process = process


class CheckContext:
    """What a check works with."""

    def __init__(self, supervisor: Channel, job: Job, variables: Mapping[str, str] | None = None) -> None:
        """Make a context on which nothing runs yet.

        Args:
            supervisor: who starts and ends the submission.
            job: what is graded.
            variables: environment variables the submission is started with, unless `launch` says otherwise.
        """
        self.job = job
        self.memory: dict[str, Any] = {}  # what the checks know of the running submission; empty after each launch
        self.conversations: dict[type, Any] = {}  # that were held, by their models
        self.record = ExchangeLog()  # what the present check and the submission have sent each other
        self._variables = dict(variables or {})
        self.random = random.Random(job.seed)  # noqa: S311 - test values, not secrets
        self._supervisor = supervisor
        self._grader_node: GraderNode | None = None
        self._started = self._spoiled = False
        self.deadline_s = 0.0
        self.spent = dict.fromkeys(PHASES, 0.0)  # seconds
        self._clock: FairClock | None = None
        self._queued_s = 0.0  # for a ROS domain, which is not the submission's fault
        self._used = self._used_before = Used()  # by the submission, in all and until it was started last
        self._state = Recent(self._look)
        self._late_s = 0.0  # by which it may have been noticed late that what was waited for had come

    @property
    def grader_node(self) -> GraderNode:
        """The grader's node on the graph of the submission.

        Raises:
            RuntimeError: nothing was launched yet; the grader module's fault.
        """
        if self._grader_node is None:
            raise RuntimeError("the check uses the graph before `launch`")
        return self._grader_node

    def launch(
        self,
        arguments: Sequence[str] = (),
        files: Mapping[str, str] | None = None,
        variables: Mapping[str, str] | None = None,
    ) -> None:
        """Start the submission on an empty graph of its own; one that runs is ended first.

        With `--attach` the graph is the one that is there.

        Args:
            arguments: what follows the program's name on its command line.
            files: texts to lay beside it, by file name; an argument that is such a name becomes the file's path.
            variables: environment variables that differ from the exercise's own; without effect with `--attach`.

        Raises:
            NotRun: arguments for a program that somebody else has started.
        """
        if arguments and self.job.mode == "attach":
            raise NotRun("it starts your program again, but with --attach your program is already running.")
        began = time.monotonic()
        self.close()
        self._spoiled = False
        self._used_before = self._used
        self.memory.clear()
        if arguments:
            self.record.sent(f"start with {' '.join(arguments)}", "message")
        domain = None if self.job.mode == "attach" else self._start(arguments, files or {}, variables or {}, "launch")
        self._grader_node = GraderNode(domain)
        self.spent["start"] += time.monotonic() - began

    def run_to_end(self) -> ProcessStatus:
        """Start the submission and wait until it has ended; for exercises that ask for a value, not for a node.

        It is ended when the check's time is up. What it has put into the job's variable is in the notes of the result,
        as `values.describe` puts it.
        """
        self._start((), {}, {}, "launch")
        while (process := ProcessStatus.from_mapping(self._ask("finish", seconds=_FINISH_S))).running:
            if self.time_is_up():
                return ProcessStatus.from_mapping(self._ask("time is up"))
        return process

    def _start(self, arguments: Sequence[str], files: Mapping[str, str], more: Mapping[str, str], what: str) -> int:
        """Have the submission started; returns its ROS domain."""
        program = {"arguments": list(arguments), "files": dict(files), "variables": {**self._variables, **more}}
        answer = self._ask(what, patience_s=limits.QUEUE_S, **program)
        self._started = True
        self._queued_s += float(answer["queued_s"])
        return int(answer["domain"])

    def close(self) -> None:
        """Take the grader's node off the graph."""
        self._started = False
        if self._grader_node is not None:
            self._grader_node.close()
            self._grader_node = None

    def begin(self, deadline_s: float) -> None:
        """Start the deadline of a check.

        Raises:
            Failed: there is nothing to check, because the program is not Python.
        """
        self.record.clear()
        if self.job.fault:
            raise Failed(Evidence("", "a Python program", "a syntax error"), self.job.fault, "start.syntax")
        self.deadline_s = deadline_s
        self._queued_s = 0.0
        self._clock = self.clock()

    def time_is_up(self) -> bool:
        """Whether the check has used up its time, fairly counted; every wait is over then."""
        return self._clock is not None and self._clock.past(self.deadline_s + self._queued_s)

    def require_time(self, evidence: Evidence) -> None:
        """See that there is time left to ask something more.

        Args:
            evidence: what is to be asked.

        Raises:
            Failed: the check has used up its time; with service.blocks.
        """
        if self.time_is_up():
            message = f"Every answer came, but so slowly that the {self.deadline_s:g} s for this check ran out."
            raise Failed(replace(evidence, got="too late to ask"), message, "service.blocks")

    @contextmanager
    def after_the_verdict(self) -> Iterator[None]:
        """Let waits go beyond the check's deadline: for a look at why it failed, and to tidy up. Both are short."""
        clock, self._clock = self._clock, None
        try:
            yield
        finally:
            self._clock = clock

    def spoil(self) -> None:
        """Remember that the running submission is dead or stuck: the next check needs a fresh one."""
        self._spoiled = True

    @property
    def spoiled(self) -> bool:
        """Whether the running submission can be asked nothing more."""
        return self._spoiled

    def clock(self, lateness: Callable[[], float] | None = None) -> FairClock:
        """A fair clock that starts now; for `lateness` see `FairClock`."""
        return self._clock_of(MOST, lateness)

    def latency_clock(self) -> FairClock:
        """A fair clock for an answer: what the grader has waited while nothing had come is not taken off."""
        before = self._late_s
        return self.clock(lambda: self._late_s - before)

    def process(self, *, fresh: bool = False) -> ProcessStatus:
        """What is known of the submission; `fresh` has it counted now instead of up to 50 ms ago."""
        if self.job.mode == "attach":
            return ProcessStatus(running=True)
        return ProcessStatus.from_mapping(self._ask("facts" if fresh else "state"))

    def lost_in(self) -> int:
        """The line by which the program's node has lost its executor; 0 where it has not."""
        line = str(self.process().notes.get("lost_in", ""))
        return int(line) if line.isdecimal() else 0

    def computed(self) -> float:
        """Seconds for which the program that was started last has computed, as of now or a moment ago."""
        return self._state.lately().submission.cpu_s - self._used_before.cpu_s

    def stacks(self) -> str:
        """What each thread of the submission is executing, by faulthandler; empty for other than Python source."""
        return str(self._ask("stacks")["stacks"]) if self.job.mode == "run" else ""

    def wait_until(
        self,
        condition: Callable[[], bool],
        seconds: float,
        *,
        most: float = MOST,
        step_s: float = _STEP_S,
        of_the_living: bool = True,
    ) -> bool:
        """Wait until `condition` holds; False when it does not within `seconds`, or before the check's time is up.

        Args:
            condition: asked again and again.
            seconds: the patience, fairly counted, as the check's deadline is.
            most: the largest part of the time that a busy machine may take away.
            step_s: how late it may be noticed that something else than a message has made it hold. Always the same
                within a wait: with another one rclpy forgets which clients it has not served yet.
            of_the_living: whether only a submission that runs can make it hold.

        Raises:
            SubmissionEndedError: the submission has ended meanwhile, and it is `of_the_living`.
        """
        clock = self._clock_of(most)
        watched, looked = 0.0, time.monotonic()
        while not condition():
            looked = time.monotonic()
            if clock.wall() - watched >= _WATCH_S:
                watched = clock.wall()
                if of_the_living:
                    self.require_running()
                patience = min(seconds, _LOST_S) if of_the_living and self.lost_in() else seconds
                if clock.past(patience) or self.time_is_up():
                    return False
            self.grader_node.spin_once(step_s)
        self._late_s += time.monotonic() - looked
        return True

    def wait_for_start(self, condition: Callable[[], bool]) -> bool:
        """Wait until `condition` holds of a program just started; False when it does not within its time to start.

        Raises:
            SubmissionEndedError: the submission has ended meanwhile.
        """
        began, job = time.monotonic(), self.job

        def is_endless() -> bool:
            """Whether it has computed for so long that no node of it will appear."""
            return self.computed() >= job.start_cpu_s and not self.grader_node.nodes()

        try:
            patience_s, most = job.limits.start_s, _MOST_OF_A_START
            self.wait_until(lambda: condition() or is_endless(), patience_s, most=most, step_s=GRAPH_STEP_S)
            return condition()
        finally:
            self.spent["discovery"] += time.monotonic() - began

    def require_running(self) -> None:
        """Raise SubmissionEndedError if the submission has ended."""
        if self.job.mode != "attach" and not self._ask("running")["running"]:
            self._spoiled = True
            raise SubmissionEndedError(self.process(), self.job)

    def _look(self) -> State:
        if self._started:
            process = self.process(fresh=True)
            self._used = self._used_before.plus(process.cpu_s, process.waited_s, process.hidden_s)
        own = Used(time.process_time(), scheduling.own_waiting())
        busy_s = machine.processor_times().busy or None
        return State(self._used, own, busy_s, scheduling.own_waiting(helpers_only=True))

    def _clock_of(self, most: float, lateness: Callable[[], float] | None = None) -> FairClock:
        return FairClock(self._state, most, machine.processor_share(), lateness)

    def _ask(self, what: str, *, patience_s: float = 0.0, **more: object) -> Record:
        self._supervisor.send({"do": what, **more})
        return self._supervisor.receive(patience_s + _RPC_S)
