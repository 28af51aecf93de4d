"""What a launcher is ordered to start: a program, the conditions it runs under, and the streams it is watched by."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping  # noqa: TC003 - msgspec looks up what a record has
from contextlib import suppress
from dataclasses import dataclass, field

from course_kit.grading.model.job import Isolation  # noqa: TC001 - as above
from course_kit.grading.model.limits import Limits  # noqa: TC001 - as above
from course_kit.grading.sandbox.file_view import FileView


@dataclass(frozen=True)
class Program:
    """What to run."""

    name: str  # the file's name, as it is to appear in tracebacks
    source: str = ""  # its text; unused with a command
    class_name: str = ""  # the Node class the exercise names, for modules that only define classes
    own_start: bool = False  # whether it has to start its node itself
    # what follows the program's name on its command line; the name of one of `files` stands for its path
    arguments: tuple[str, ...] = ()
    files: Mapping[str, str] = field(default_factory=dict)  # texts to lay into its scratch directory, by file name
    command: tuple[str, ...] = ()  # an executable with its arguments to start instead of Python source
    folder: str = ""  # the working directory of a command; source runs in its scratch directory
    variable: str = ""  # what the program is to set, when it is asked for a value and not for a node
    launches: bool = False  # whether it is a launch file, which starts programs among its files


@dataclass
class Conditions:
    """Under which conditions a program runs."""

    limits: Limits  # what it may use
    isolation: Isolation  # what is known to hold on this machine
    scratch: str  # the folder in which its scratch directory is made; within the sandbox that directory itself
    view: FileView = field(default_factory=FileView)  # the files it sees
    # variables to set for the program, beside HOME, TMPDIR and PWD
    environment: Mapping[str, str] = field(default_factory=dict)
    priority: int = 0  # the nice value to run at
    others: int = 0  # the user's other processes and threads where the kernel counts them together with the program's
    user: int = 0  # the number of the user and group it runs as; 0 for the grader's own


@dataclass
class Streams:
    """The ends of the pipes of one sandbox: one set for this side, the other for the inside."""

    stdout: int
    stderr: int
    status: int
    evidence: int
    control: int

    def descriptors(self) -> tuple[int, ...]:
        """All of them, in the order of the arguments."""
        return (self.stdout, self.stderr, self.status, self.evidence, self.control)

    def tell(self, **what: object) -> None:
        """From the inside: tell the supervisor facts, on the stream for them."""
        with suppress(OSError):
            os.write(self.status, json.dumps(what).encode() + b"\n")

    def close(self) -> None:
        """Close all of them, once."""
        for name in ("stdout", "stderr", "status", "evidence", "control"):
            descriptor = getattr(self, name)
            if descriptor >= 0:
                os.close(descriptor)
                setattr(self, name, -1)
