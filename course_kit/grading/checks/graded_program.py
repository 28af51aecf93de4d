"""The submission as its supervisor runs it: started, looked at, ended."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.fair_clock import ProcessorUse
from course_kit.grading.diagnosis import exits
from course_kit.grading.diagnosis.tracebacks import Frame
from course_kit.grading.model.job import ProcessStatus
from course_kit.grading.model.plain_data import convert_record

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from mmap import mmap

    from course_kit.grading.model.job import Job
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.sandbox.channel import Channel

_FINISH_S = 0.25  # how often it is asked whether the time is up, while a program's end is waited for
_RPC_S = 30.0  # the supervisor answers in milliseconds; without it there is no grading


class SubmissionEndedError(Failed):
    """The submission's process has ended while something was expected of it; by itself explained as during a call."""

    def __init__(self, process: ProcessStatus, job: Job) -> None:
        diagnosis, message = exits.explain_call(process, job)
        super().__init__(Evidence(got="the program has ended"), message, diagnosis)
        self.process = process


class GradedProgram:
    """A submission."""

    def __init__(self, supervisor: Channel, job: Job, variables: Mapping[str, str], lives: mmap | bytes) -> None:
        self._supervisor, self._variables, self._lives = supervisor, dict(variables), lives
        self.job = job  # what is graded; of several programs the one that was started last
        self._runs = False
        self._used = self._used_before = ProcessorUse()  # in all, and until it was started last
        self.asked = ""  # of several that run, the file whose node was asked last
        self.stderr = ""  # what it had written when it was looked at last

    def start(self, arguments: Sequence[str], files: Mapping[str, str], more: Mapping[str, str]) -> int | None:
        """Have it started, with more variables; the ROS domain it is in, None where somebody else has started it."""
        self._runs, self._used_before, self.asked, self.stderr = False, self._used, "", ""
        if self.job.mode == "attach":
            return None
        words = {"program": self.job.name, "arguments": list(arguments), "files": dict(files)}
        variables = {**self._variables, **more}
        answer = self._ask("launch", variables=variables, **words)
        self._runs = True
        return int(answer["domain"])

    def run_to_end(self, time_is_up: Callable[[], bool]) -> ProcessStatus:
        """Start it and wait until it has ended, by itself or because the time is up."""
        self.start((), {}, {})
        while (process := self._ask_status("finish", seconds=_FINISH_S)).running:
            if time_is_up():
                return self._ask_status("time is up")
        return process

    def forget(self) -> None:
        """Look at it no more: its graph is left."""
        self._runs = False

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
        return self.job.for_program(self.asked) if self.asked in self.job.files else self.job

    def stacks(self) -> str:
        """What each of its threads is executing, by faulthandler; empty for other than Python source."""
        return str(self._ask("stacks", program=self.asked)["stacks"]) if self.job.mode == "run" else ""

    def kill(self, program: str) -> bool:
        """Kill the process that runs one of its files; False when no process does."""
        return bool(self._ask("kill", program=program)["killed"])

    def processor_use(self) -> ProcessorUse:
        """What it has used of the processors, in all its starts."""
        if self._runs:
            process = self.status(fresh=True)
            self._used = self._used_before.add_seconds(process.cpu_s, process.waited_s, process.hidden_s)
        return self._used

    def computed_since_start(self, used: ProcessorUse) -> float:
        """Seconds of these for which it has computed since it was started last."""
        return used.cpu_s - self._used_before.cpu_s

    def _ask_status(self, what: str, **more: Any) -> ProcessStatus:
        return convert_record(self._ask(what, **more), ProcessStatus)

    def _ask(self, what: str, **more: object) -> Record:
        self._supervisor.send({"do": what, **more})
        return self._supervisor.receive(_RPC_S)
