"""What a launcher is ordered to start: a program, the conditions it runs under, and the streams it is watched by.

What is around the program, process by process, is in `launcher`, `init_process` and `runner`. What it is not is said in
LIMITS.md, the page for users.
"""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Mapping  # noqa: TC003 - msgspec looks up what a record has
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.model.job import Isolation  # noqa: TC001 - as above
from course_kit.grading.model.limits import Limits  # noqa: TC001 - as above
from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.sandbox import file_view
from course_kit.grading.sandbox.file_view import FileView
from course_kit.interfaces.sources import PATH_VARIABLE, path_with
from course_kit.process import tree

if TYPE_CHECKING:
    from course_kit.grading.model.job import Job
    from course_kit.grading.model.plain_data import Record

_COUNTS_BY_NAMESPACE = (5, 14)  # Linux
# What the user's other programs, gradings among them, may start while this one runs.
_STARTED_MEANWHILE = 4096
_NO_BYTECODE = {"PYTHONDONTWRITEBYTECODE": "1"}  # a program leaves nothing beside what it imports


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
class StartOrder:
    """A program, and under which conditions it runs."""

    program: Program
    limits: Limits  # what it may use
    isolation: Isolation  # what is known to hold on this machine
    scratch: str  # its scratch directory
    view: FileView = field(default_factory=FileView)  # the files it sees
    # variables to set for the program, beside HOME, TMPDIR and PWD
    environment: Mapping[str, str] = field(default_factory=dict)
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
        return tuple(vars(self).values())

    def tell(self, **what: object) -> None:
        """From the inside: tell the supervisor facts, on the stream for them."""
        with suppress(OSError):
            os.write(self.status, json.dumps(what).encode() + b"\n")

    def close(self) -> None:
        """Close all of them, once."""
        for name, descriptor in vars(self).items():
            if descriptor >= 0:
                os.close(descriptor)
                setattr(self, name, -1)


def make_start_order(
    job: Job, message: Record, variables: Mapping[str, str], view: FileView, scratch: str
) -> StartOrder:
    """The order to start a job's program as a message of the grader process wants it, in an empty directory."""
    user = _user(job)
    text = job.text
    beside = {name: file.source for name, file in job.text.files.items() if name != text.program}
    words = {"name": text.program, "source": text.source, "launches": job.launches}
    words |= {"arguments": message["arguments"], "files": beside | message["files"]}
    program = convert_record({**vars(job), **words}, Program)  # of the job no more than that has fields for
    hidden = job.hidden
    if job.command:
        view = file_view.find_view(job.command, job.folder)
        hidden = tuple(path for path in hidden if not Path(job.folder).is_relative_to(path))  # a user's own choice
    # Tasks that the kernel counts with the submission's: before Linux 5.14 all of the user's, and what may yet come.
    version = tuple(int(part) for part in os.uname().release.split(".")[:2])
    counted_apart = user or (job.isolation.processes and version >= _COUNTS_BY_NAMESPACE)
    interfaces = {PATH_VARIABLE: path_with(job.interfaces)} if job.interfaces else {}  # before others of one name
    return StartOrder(
        program,
        limits=job.limits,
        isolation=job.isolation,
        scratch=scratch,
        view=view.with_more(shown=filter(None, (job.interfaces,)), masked=hidden),
        environment={**_NO_BYTECODE, **message["variables"], **variables, **interfaces},
        others=0 if counted_apart else tree.tasks_of_user(os.getuid()) + _STARTED_MEANWHILE,
        user=user,
    )


def _user(job: Job) -> int:
    """Whom the submission runs as: a command of root's own stays root where others cannot get at what it names."""
    if job.command:
        for path in map(Path, (job.folder, *file_view.named_paths(job.command[1:], job.folder))):
            around = (path, *path.parents) if path.is_dir() else path.parents
            if not all(place.stat().st_mode & stat.S_IXOTH for place in around):
                return 0
    return job.user
