"""What a worker is asked to do, what isolates a submission meanwhile, and what has come of it: as plain data."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal, TypedDict

import msgspec

from course_kit.grading.errors import GradingError
from course_kit.grading.model.limits import Limits
from course_kit.grading.model.plain_data import Record  # noqa: TC001 - msgspec looks it up
from course_kit.grading.model.submission import LAUNCH_FILE, Submission, SyntaxFault
from course_kit.ros.names import from_root


@dataclass(frozen=True)
class Isolation:
    """What holds beside resource limits, an own session and an own scratch directory, which always do."""

    network: bool = False  # own network namespace: only the grader and the submission are on its loopback
    # own PID namespace: the submission can neither see, signal nor trace anything outside, and the kernel ends all it
    # has started together with it
    processes: bool = False
    files: bool = False  # own file system: an allow-list, read-only but for the scratch directory, which lies in memory
    # an allow-list of files kept by Landlock; only used without a separate file system
    landlock: bool = False
    syscalls: bool = False  # system calls that lead out of the sandbox are refused
    user: bool = False  # its own user, without rights; only for a grader that runs as root
    root: bool = False  # whether the grader runs as root
    reason: str = ""  # why something of these is missing, for people; empty when all hold

    @property
    def is_full(self) -> bool:
        """Whether all holds that LIMITS.md promises of a machine which allows namespaces."""
        return self.network and self.processes and self.files and self.syscalls and (self.user or not self.root)

    def require(self) -> None:
        """Insist on all of it."""
        if not self.is_full:
            raise GradingError(
                "Nothing was graded: --require-isolation asks for full isolation, and this machine does not offer it. "
                f"It offers: {self.describe()}. Grade on another machine, or leave --require-isolation out and read "
                "course_kit/grading/LIMITS.md."
            )

    def describe(self) -> str:
        """One line for people."""
        kinds = [
            ("own network (loopback only)", "own network", self.network),
            ("own processes", "own processes", self.processes),
            ("own file system", "own file system", self.files),
            ("filtered system calls", "filter of system calls", self.syscalls),
        ]
        if self.landlock and not self.files:
            kinds.append(("files by allow-list (Landlock)", "", True))
        if self.root:
            kinds.append(("own user", "own user (this is root)", self.user))
        holds = [text for text, _, there in kinds if there]
        missing = [name for _, name, there in kinds if not there]
        text = ", ".join([*holds, "resource limits, own session, own ROS domain, scratch directory"])
        if missing:
            text += f". Missing: {', '.join(missing)}, because {self.reason or 'of an unknown reason'}"
        return text


class ExerciseEndpoint(msgspec.Struct, forbid_unknown_fields=True):
    """What a program has, as exercise.toml names it."""

    kind: Literal["service", "action", "publisher", "subscription"]
    name: str
    type: Annotated[str, msgspec.Meta(pattern=r"\A\w+/(?:msg|srv|action)/\w+\Z")]  # `package/srv/Name`
    program: str = ""  # the one of the exercise's files whose node has it; empty where there is one program

    def __post_init__(self) -> None:
        """Name it from the root."""
        self.name = from_root(self.name)


@dataclass(frozen=True)
class Job:
    """One grading."""

    grader: str  # what checks it, see `workers.exercise_job`
    mode: str  # "run" for a program, "exec" for a command, "attach" for what is already on the graph
    seed: int  # what the random values of the checks are drawn from
    text: Submission = field(default_factory=Submission)  # the program; of several files the one started last
    class_name: str = ""  # the Node class the exercise names
    # whether the program has to start its node itself; else the class that it only defines is started
    own_start: bool = False
    variable: str = ""  # the variable it names instead, when it needs no ROS
    command: tuple[str, ...] = ()  # the executable and its arguments, for "exec"
    folder: str = ""  # the working directory of a command
    limits: Limits = field(default_factory=Limits)  # what the submission may use
    isolation: Isolation = field(default_factory=Isolation)  # filled in by the worker, which has tried it out
    hidden: tuple[str, ...] = ()  # folders to keep out of the submission's sight, wherever they lie
    # the folder with the interfaces that the exercise brings, which the submission sees; empty for none
    interfaces: str = ""
    points: float = 0.0  # the exercise's full marks, which its checks have to add up to; 0 when nobody asks
    user: int = 0  # the number of the user that submissions run as; 0 for the grader's own; filled in by the worker
    scratch: str = ""  # the folder for the scratch directory; filled in by the worker
    # stop at the first failed check that costs points, for whoever only asks whether there is one
    first_failure: bool = False
    only: str = ""  # the part whose checks are run, see `check.choose_part`; empty for all
    # what the exercise wants offered, published and subscribed to, as its exercise.toml has it
    endpoints: tuple[ExerciseEndpoint, ...] = ()

    def for_program(self, name: str) -> Job:
        """The same with another one of its files as the program; one that is missing is no Python."""
        lacks = f"the file {name} is missing in what you have handed in"
        text = self.text.files.get(name) or Submission(name, name, "", fault=SyntaxFault(0, "", lacks))
        return replace(self, text=replace(text, files=self.text.files))

    @property
    def programs(self) -> tuple[str, ...]:
        """The names of all files that may be in its tracebacks."""
        return tuple(self.text.files) or (self.text.program,)

    @property
    def launches(self) -> bool:
        """Whether several of its files run, started by the launch file."""
        return bool(self.text.files) and self.text.program.endswith(LAUNCH_FILE)

    @property
    def start_cpu_s(self) -> float:
        """Seconds of computing in which a node has to appear; a command has yet to load what a program finds loaded."""
        return self.limits.start_cpu_s if self.mode == "run" else math.inf


class GradingOutcome(TypedDict):
    """The outcome."""

    results: list[Record]  # of each check, as a record of `report.CheckResult`
    stdout: str  # first and last 4 kB of what the submission printed
    stderr: str  # the same of its errors
    problem: str  # why the grading came to no end; empty when it did
    again: bool  # whether it may go better the next time, because something was killed that should not be


@dataclass(frozen=True)
class ProcessStatus:
    """What the supervisor knows of the submission; hints for the diagnosis, see `sandbox.output_collector`."""

    running: bool
    exit_code: int | None = None
    signal: int | None = None
    limit: str | None = None
    cpu_s: float = 0.0
    waited_s: float = 0.0
    hidden_s: float = 0.0
    stdout: str = ""
    stderr: str = ""
    notes: Record = field(default_factory=dict)
