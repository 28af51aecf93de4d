"""The test bench of one grading: the grader's own node, and the verbs a check speaks in.

Every wait has a deadline and ends early when the submission has. Runs in the probe, a process apart from the
submission and from the one that writes the report.
"""

from __future__ import annotations

import random
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from course_kit.grading import endings, processes
from course_kit.grading.checks import Evidence, Failed, NotRun
from course_kit.grading.patience import FairClock, Recent
from course_kit.grading.steps import Record
from course_kit.grading.tester import Tester

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from course_kit.grading.job import Job
    from course_kit.grading.wire import Channel

_STEP_S = 0.02  # how often a condition is looked at beside each message: looking costs computing, which others need
GRAPH_STEP_S = 0.01  # the same for what a change of the graph makes true: rclpy has no event for that
_WATCH_S = 0.02  # how often it is asked whether the submission lives, while an answer is waited for
PHASES = ("start", "discovery")  # where time goes beside checking: the program's making, and its way onto the graph
_MOST_OF_A_START = 0.92  # nothing is measured by how long a start takes: on a very busy machine, twelve times as long
_RPC_S = 30.0  # the warden answers in milliseconds; without it there is no grading


@dataclass(frozen=True)
class Life:
    """What the warden knows of the submission; hints for the diagnosis, see `course_kit.grading.life`."""

    running: bool
    exit_code: int | None = None
    signal: int | None = None
    limit: str | None = None
    cpu_s: float = 0.0
    waited_s: float = 0.0
    tasks: int = 0
    memory: int = 0
    stdout: str = ""
    stderr: str = ""
    notes: dict[str, Any] = field(default_factory=dict)


class SubmissionEndedError(Failed):
    """The submission's process has ended while something was expected of it; by itself explained as during a call."""

    def __init__(self, life: Life, job: Job) -> None:
        diagnosis, message = endings.of_call(life, job)
        super().__init__(Evidence(got="the program has ended"), message, diagnosis)
        self.life = life


class Bench:
    """What a check works with."""

    def __init__(self, warden: Channel, job: Job, variables: Mapping[str, str] | None = None) -> None:
        """Make a bench on which nothing runs yet.

        Args:
            warden: who starts and ends the submission.
            job: what is graded.
            variables: environment variables the submission is started with, unless `launch` says otherwise.
        """
        self.job = job
        self.memory: dict[str, Any] = {}  # what the checks know of the running submission; empty after each launch
        self.record = Record()  # what the present check and the submission have sent each other
        self._variables = dict(variables or {})
        self.random = random.Random(job.seed)  # noqa: S311 - test values, not secrets
        self._warden = warden
        self._tester: Tester | None = None
        self._spoiled = False
        self.deadline_s = 0.0
        self.spent = dict.fromkeys(PHASES, 0.0)  # seconds
        self._clock: FairClock | None = None
        self._waiting, self._own_waiting = Recent(self._waited), Recent(processes.own_waiting)

    @property
    def tester(self) -> Tester:
        """The grader's node on the graph of the submission.

        Raises:
            RuntimeError: nothing was launched yet; the grader module's fault.
        """
        if self._tester is None:
            raise RuntimeError("the check uses the graph before `launch`")
        return self._tester

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
            raise NotRun("it starts your program anew with other arguments, and with --attach it was started already.")
        began = time.monotonic()
        self.close()
        self._spoiled = False
        self._waiting = Recent(self._waited)
        self.memory.clear()
        if arguments:
            self.record.sent(f"start with {' '.join(arguments)}", "message")
        domain = None
        if self.job.mode != "attach":
            changed = {**self._variables, **(variables or {})}
            answer = self._ask("launch", arguments=list(arguments), files=dict(files or {}), variables=changed)
            domain = int(answer["domain"])
        self._tester = Tester(domain)
        self.spent["start"] += time.monotonic() - began

    def run_to_end(self) -> Life:
        """Start the submission and wait until it has ended; for exercises that ask for a value, not for a node.

        What it has put into the job's variable is in the notes of the result, as `values.describe` puts it.
        """
        self._ask("launch", arguments=[], files={}, variables=self._variables)
        return _life(self._ask("finish", patience_s=self.job.limits.wall_s))

    def close(self) -> None:
        """Take the grader's node off the graph."""
        if self._tester is not None:
            self._tester.close()
            self._tester = None

    def begin(self, deadline_s: float) -> None:
        """Start the deadline of a check.

        Raises:
            Failed: there is nothing to check, because the program is not Python.
        """
        self.record.clear()
        if self.job.fault:
            raise Failed(Evidence("", "a Python program", "a syntax error"), self.job.fault, "start.syntax")
        self.deadline_s = deadline_s
        self._clock = self.clock()

    def time_is_up(self) -> bool:
        """Whether the check has used up its time, fairly counted."""
        return self._clock is not None and self._clock.past(self.deadline_s)

    def spoil(self) -> None:
        """Remember that the running submission is dead or stuck: the next check needs a fresh one."""
        self._spoiled = True

    @property
    def spoiled(self) -> bool:
        """Whether the running submission can be asked nothing more."""
        return self._spoiled

    def clock(self, own_waiting: Callable[[], float] | None = None) -> FairClock:
        """A fair clock that starts now.

        Args:
            own_waiting: seconds the grader has waited for a processor, for whoever knows better than the kernel, which
                counts that of a grader too that only looks whether something has come yet.
        """
        return FairClock(self._waiting, Recent(own_waiting) if own_waiting else self._own_waiting)

    def life(self, *, fresh: bool = False) -> Life:
        """What is known of the submission; `fresh` has it counted now instead of up to 50 ms ago."""
        if self.job.mode == "attach":
            return Life(running=True)
        return _life(self._ask("facts" if fresh else "state"))

    def stacks(self) -> str:
        """What each thread of the submission is executing, by faulthandler; empty for other than Python source."""
        return str(self._ask("stacks")["stacks"]) if self.job.mode == "run" else ""

    def wait_until(
        self, condition: Callable[[], bool], seconds: float, most: float | None = None, *, step_s: float = _STEP_S
    ) -> bool:
        """Wait until `condition` holds; False when it does not within `seconds`, fairly counted.

        Args:
            condition: asked again and again.
            seconds: the patience.
            most: the largest part of the time that a busy machine may take away; the usual one when None.
            step_s: how late it may be noticed that something else than a message has made it hold. Always the same
                within a wait: with another one rclpy forgets which clients it has not served yet.

        Raises:
            SubmissionEndedError: the submission has ended meanwhile.
        """
        clock = self.clock() if most is None else FairClock(self._waiting, self._own_waiting, most)
        watched = 0.0
        while not condition():
            if clock.wall() - watched >= _WATCH_S:
                watched = clock.wall()
                self.require_running()
                if clock.past(seconds):
                    return False
            self.tester.spin_once(step_s)
        return True

    def wait_for_start(self, condition: Callable[[], bool]) -> bool:
        """Wait until `condition` holds of a program just started; False when it does not within its time to start.

        Raises:
            SubmissionEndedError: the submission has ended meanwhile.
        """
        began = time.monotonic()
        try:
            return self.wait_until(condition, self.job.limits.start_s, _MOST_OF_A_START, step_s=GRAPH_STEP_S)
        finally:
            self.spent["discovery"] += time.monotonic() - began

    def require_running(self) -> None:
        """Raise SubmissionEndedError if the submission has ended."""
        if self.job.mode != "attach" and not self._ask("running")["running"]:
            self._spoiled = True
            raise SubmissionEndedError(self.life(), self.job)

    def _waited(self) -> float:
        return self.life(fresh=True).waited_s if self._tester is not None else 0.0

    def _ask(self, what: str, *, patience_s: float = 0.0, **more: Any) -> dict[str, Any]:
        self._warden.send({"do": what, **more})
        return self._warden.receive(patience_s + _RPC_S)


def _life(facts: dict[str, Any]) -> Life:
    return Life(**{name: value for name, value in facts.items() if name in Life.__dataclass_fields__})
