"""What a check works with: the program, the grader's node beside it, clocks, and what is kept of the exchange.

Every wait has a deadline and ends early when the submission has. Runs in the grader process, a process apart from the
submission and from the one that writes the report.
"""

from __future__ import annotations

import random
import time
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.evidence import NODE, Evidence, ExchangeLog, Failed, NotRun
from course_kit.grading.checks.fair_clock import MOST, CachedState, FairClock, MachineState, ProcessorUse
from course_kit.grading.checks.grader_node import GraderNode
from course_kit.grading.diagnosis import causes
from course_kit.grading.diagnosis.tracebacks import Frame
from course_kit.grading.model.job import ProcessStatus
from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.sandbox import machine

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from mmap import mmap

    from course_kit.grading.model.job import Job
    from course_kit.grading.model.plain_data import Record
    from course_kit.process.channel import Channel
    from course_kit.ros.graph import Overview

_STEP_S = 0.02  # how often a condition is looked at beside each message: looking costs computing, which others need
GRAPH_STEP_S = 0.01  # the same for what a change of the graph makes true: rclpy has no event for that
ANSWER_S, ANSWER_AGAIN_S = 5.0, 2.0  # how long an answer is waited for, and after one that never came
_LOST_S = 2.0  # for an answer of a node that no executor runs any more; it may be on its way
_WATCH_S = 0.05  # how often it is asked whether the submission lives, while an answer is waited for
_MOST_OF_A_START = 0.92  # nothing is measured by how long a start takes: on a very busy machine, twelve times as long
_FINISH_S = 0.25  # how often it is asked whether the time is up, while a program's end is waited for
_RPC_S = 30.0  # the supervisor answers in milliseconds; without it there is no grading


class SubmissionEndedError(Failed):
    """The submission's process has ended while something was expected of it; by itself explained as during a call."""

    def __init__(self, process: ProcessStatus, job: Job) -> None:
        diagnosis, message = causes.explain_call(process, job)
        super().__init__(Evidence(got="the program has ended"), message, diagnosis)
        self.process = process


class GradedProgram:
    """A submission."""

    def __init__(self, supervisor: Channel, job: Job, variables: Mapping[str, str], lives: mmap | bytes) -> None:
        self._supervisor, self._variables, self._lives = supervisor, dict(variables), lives
        self.job = job  # what is graded; of several programs the one that was started last
        self._used = self.used_before = ProcessorUse()  # in all, and until it was started last
        self.asked = ""  # of several that run, the file whose node was asked last
        self.stderr = ""  # what it had written when it was looked at last

    def start(self, arguments: Sequence[str], files: Mapping[str, str], more: Mapping[str, str]) -> int | None:
        """Have it started, with more variables; the ROS domain it is in, None where somebody else has started it."""
        self.used_before, self.asked, self.stderr = self._used, "", ""
        if self.job.mode == "attach":
            return None
        words = {"program": self.job.text.program, "arguments": list(arguments), "files": dict(files)}
        variables = {**self._variables, **more}
        return int(self._ask("launch", variables=variables, **words)["domain"])

    def run_to_end(self, time_is_up: Callable[[], bool]) -> ProcessStatus:
        """Start it and wait until it has ended, by itself or because the time is up."""
        self.start((), {}, {})
        while (process := self._ask_status("finish", seconds=_FINISH_S)).running:
            if time_is_up():
                return self._ask_status("time is up")
        return process

    def status(self, *, fresh: bool = False) -> ProcessStatus:
        """What is known of it; `fresh` has it counted now instead of up to 50 ms ago."""
        if self.job.mode == "attach":
            return ProcessStatus(running=True)
        status = self._ask_status("facts" if fresh else "state")
        self.stderr = status.stderr
        return status

    def is_alive(self) -> bool:
        """Whether it has not ended."""
        return self.job.mode == "attach" or bool(self._lives[0])

    def lost_in(self) -> Frame | None:
        """The line by which its node has lost its executor; None where it has not."""
        name, _, line = str(self.status().notes.get("lost_in", "")).rpartition(":")
        return Frame(name, int(line), "") if line.isdecimal() else None

    @property
    def asked_job(self) -> Job:
        """The job of the program that was asked last, of several that run."""
        return self.job.for_program(self.asked) if self.asked in self.job.text.files else self.job

    def stacks(self) -> str:
        """What each of its threads is executing, by faulthandler; empty for other than Python source."""
        return str(self._ask("stacks", program=self.asked)["stacks"]) if self.job.mode == "run" else ""

    def kill(self, program: str) -> None:
        """Kill the process that runs one of its files."""
        self._ask("kill", program=program)

    def processor_use(self) -> ProcessorUse:
        """What it has used of the processors, in all its starts."""
        own = self.status(fresh=True)
        wait_s = machine.somebody_waited() - self.used_before.waited_s if self.job.mode == "attach" else own.waited_s
        seconds = (own.cpu_s, wait_s, own.hidden_s)  # of an attached node: whoever waited, it may be that
        self._used = ProcessorUse(*map(sum, zip(self.used_before, seconds, strict=True)))
        return self._used

    def _ask_status(self, what: str, **more: Any) -> ProcessStatus:
        return convert_record(self._ask(what, **more), ProcessStatus)

    def _ask(self, what: str, **more: object) -> Record:
        self._supervisor.send({"do": what, **more})
        return self._supervisor.receive(_RPC_S)


class CheckContext:
    """What a check works with."""

    def __init__(
        self, supervisor: Channel, job: Job, variables: Mapping[str, str] | None = None, lives: mmap | bytes = b"\0"
    ) -> None:
        """Make a context on which nothing runs yet; `lives` is one byte, which says whether the submission does."""
        self.program = GradedProgram(supervisor, job, variables or {}, lives)
        self.record = ExchangeLog()  # what the present check and the submission have sent each other
        self.random = random.Random(job.seed)  # noqa: S311 - test values, not secrets
        self.memory: dict[str, Any] = {}  # what the checks know of the running submission; empty after each launch
        self.conversations: dict[type, Any] = {}  # that were held, by their models
        self.patience_s = ANSWER_S  # how long an answer is waited for
        self.deadline_s = 0.0
        self._grader_node: GraderNode | None = None
        self.spoiled = False  # the running submission can be asked nothing more
        self._clock: FairClock | None = None
        self._state = CachedState(self._look)
        self._late_s = 0.0  # by which it may have been noticed late that what was waited for had come

    @property
    def job(self) -> Job:
        """What is graded."""
        return self.program.job

    @property
    def grader_node(self) -> GraderNode:
        """The grader's node on the graph of the submission."""
        if self._grader_node is None:
            raise RuntimeError("the check uses the graph before `launch`")
        return self._grader_node

    def launch(
        self,
        arguments: Sequence[str] = (),
        files: Mapping[str, str] | None = None,
        variables: Mapping[str, str] | None = None,
        program: str = "",
    ) -> None:
        """Start the submission on its own empty graph, with the exercise's variables and these; end one that runs."""
        if arguments and self.job.mode == "attach":
            raise NotRun("because it starts your program again, but with --attach your program is already running.")
        self.close()
        self.spoiled = False
        self.memory.clear()
        if program:
            self.program.job = self.job.for_program(program)
            self._require_python()
            self.turn_to(program)
        if arguments or program:
            start = f"start {program}".rstrip() + (f" with {' '.join(arguments)}" if arguments else "")
            self.record.add_sent(start, "message")
        self._grader_node = GraderNode(self.program.start(arguments, files or {}, variables or {}))

    def turn_to(self, program: str) -> None:
        """Talk with the node of this file from now on, of a submission of several."""
        self.program.asked = program if self.job.launches else ""
        self.record.partner = program.removesuffix(".py") if self.job.text.files and program else NODE

    def see_graph(self) -> Overview | None:
        """Who talks to whom at this moment; None for a submission of one program, or where none has been started."""
        return self._grader_node.see_graph() if self.job.text.files and self._grader_node else None

    def close(self) -> None:
        """Take the grader's node off the graph."""
        if self._grader_node is not None:
            self._grader_node.close()
            self._grader_node = None

    def begin(self, deadline_s: float) -> None:
        """Start the deadline of a check."""
        self.record.clear()
        if not self.job.text.files:
            self._require_python()
        self.deadline_s = deadline_s
        self._clock = self.clock()

    def _require_python(self) -> None:
        got, code = ("a syntax error", "start.syntax") if self.job.text.source else ("none", None)
        if problem := self.job.text.problem:
            raise Failed(Evidence("", "a Python program", got), problem, code)

    def time_is_up(self) -> bool:
        """Whether the check has used up its time, fairly counted; every wait is over then."""
        return self._clock is not None and self._clock.has_passed(self.deadline_s)

    def spoil(self) -> None:
        """Remember that the running submission is dead or stuck: the next check needs a fresh one."""
        self.spoiled = True

    def clock(self, lateness: Callable[[], float] | None = None, most: float = MOST) -> FairClock:
        """A fair clock that starts now; for its arguments see `FairClock`."""
        return FairClock(self._state, most, machine.processor_share(), lateness)

    def latency_clock(self) -> FairClock:
        """A fair clock for an answer: what the grader has waited while nothing had come is not taken off."""
        before = self._late_s
        return self.clock(lambda: self._late_s - before)

    def has_computed_enough(self) -> bool:
        """Whether the program that was started last has computed for so long that its node should have appeared."""
        computed_s = self._state.recent_state().submission.cpu_s - self.program.used_before.cpu_s
        return computed_s >= self.job.start_cpu_s

    def wait_until(  # noqa: PLR0913 - in which waits differ
        self,
        condition: Callable[[], bool],
        seconds: float,
        *,
        most: float = MOST,  # the largest part of the time that a busy machine may take away
        step_s: float = _STEP_S,  # how late it may be noticed that something else than a message has made it hold
        of_the_living: bool = True,  # whether only a submission that runs can make it hold
        by_deadline: bool = True,  # whether the check's deadline ends it; else it is a short look at why a check failed
    ) -> bool:
        """Wait until `condition` holds; False when it does not within `seconds`, fairly counted."""
        clock = self.clock(most=most)
        watched, looked = 0.0, time.monotonic()
        while not condition():
            looked = time.monotonic()
            if clock.wall_s() - watched >= min(_WATCH_S, seconds):
                watched = clock.wall_s()
                if of_the_living and not self.program.is_alive():
                    self.spoiled = True
                    raise SubmissionEndedError(self.program.status(), self.job)
                if of_the_living and clock.has_passed(_LOST_S) and self.program.lost_in():
                    return False
                if clock.has_passed(seconds) or (by_deadline and self.time_is_up()):
                    return False
            self.grader_node.spin_once(step_s)
        self._late_s += time.monotonic() - looked
        return True

    def wait_for_start(self, condition: Callable[[], bool]) -> None:
        """Wait until `condition` holds of a program just started, or its time to start is over."""

        def is_over() -> bool:
            return condition() or (self.has_computed_enough() and not self.grader_node.nodes())

        self._state()  # until the sandbox stands: on a busy machine that takes seconds, which are not the program's
        self.wait_until(is_over, self.job.limits.start_s, most=_MOST_OF_A_START, step_s=GRAPH_STEP_S)

    def _look(self) -> MachineState:
        waited_s, helpers_waited_s = machine.own_waiting()
        own, busy_s = ProcessorUse(time.process_time(), waited_s), machine.processors_worked() or None
        return MachineState(self.program.processor_use(), own, busy_s, helpers_waited_s)
