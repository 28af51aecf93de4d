"""A submission's sandbox as the supervisor of a grading sees it: what it is given, its streams, its end.

What is around the program, process by process, is in `launcher`, `init_process` and `runner`. What it is not is said in
LIMITS.md, the page for users.
"""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading.sandbox import file_view
from course_kit.grading.sandbox.start_order import Conditions, Program, Streams
from course_kit.interfaces.sources import PATH_VARIABLE, path_with
from course_kit.process import tree

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.grading.model.job import Job
    from course_kit.grading.sandbox.file_view import FileView
    from course_kit.grading.sandbox.launcher import Launcher


_COUNTS_BY_NAMESPACE = (5, 14)  # Linux
# What the user's other programs, gradings among them, may start while this one runs.
_STARTED_MEANWHILE = 4096
_NO_BYTECODE = {"PYTHONDONTWRITEBYTECODE": "1"}  # a program leaves nothing beside what it imports


class Sandbox:
    """One running submission."""

    def __init__(self, program: Program, cell: Conditions, launcher: Launcher, network: Sequence[int] = ()) -> None:
        """Start `program`. Returns at once; whether it starts well is seen in what comes out of `streams`."""
        self._launcher = launcher
        self._folder = tempfile.mkdtemp(prefix="course-kit-", dir=cell.scratch or None)
        if cell.user:
            os.chown(self._folder, cell.user, cell.user)
        self.streams, inside = _pipes()
        try:
            launcher.start(program, replace(cell, scratch=self._folder), inside, network)
        finally:
            inside.close()

    def ask(self, what: bytes) -> None:
        """Ask the init process for `SAMPLE`, `STACKS` or `KILL`; the answer comes on its stream."""
        with suppress(OSError):  # it has ended; so its stream says
            os.write(self.streams.control, what + b"\n")

    def end(self) -> None:
        """Kill all that was started; returns when it is dead and its scratch directory gone."""
        try:
            self._launcher.end()
        finally:
            shutil.rmtree(self._folder, ignore_errors=True)


def _pipes() -> tuple[Streams, Streams]:
    pipes = [os.pipe() for _ in range(5)]
    (stdout, stderr, status, evidence, control) = pipes
    ours = Streams(stdout[0], stderr[0], status[0], evidence[0], control[1])
    inside = Streams(stdout[1], stderr[1], status[1], evidence[1], control[0])
    for descriptor in ours.descriptors():
        os.set_blocking(descriptor, False)
    return ours, inside


def conditions_of(job: Job, variables: Mapping[str, str], view: FileView) -> Conditions:
    """The conditions."""
    user = _user(job)
    return Conditions(
        limits=job.limits,
        isolation=job.isolation,
        scratch=job.scratch,
        view=_view(job, view),
        environment={**_NO_BYTECODE, **variables, **_interface_path(job)},
        priority=job.priority,
        others=0 if user else _others(job),
        user=user,
    )


def program_of(job: Job, arguments: tuple[str, ...], files: Mapping[str, str]) -> Program:
    """The program of a job, for one start."""
    return Program(
        name=job.name,
        source=job.source,
        class_name=job.class_name,
        own_start=job.own_start,
        arguments=arguments,
        files={**{name: one.source for name, one in job.files.items() if name != job.name}, **files},
        command=job.command,
        folder=job.folder,
        variable=job.variable,
        launches=job.launches,
    )


def expect_few_participants() -> dict[str, str]:
    """Have Fast DDS announce itself to fewer ports than on a graph that a whole machine shares."""
    name = environment.middleware.PROFILE_VARIABLE
    if os.environ.get(name) != str(environment.LOOPBACK_PROFILE):
        return {}
    os.environ[name] = str(environment.PRIVATE_NETWORK_PROFILE)
    return {name: os.environ[name]}


def _view(job: Job, view: FileView) -> FileView:
    """The files that the submission sees."""
    hidden = job.hidden
    if job.command:
        view = file_view.view_of_command(job.command, job.folder)
        hidden = tuple(one for one in hidden if not Path(job.folder).is_relative_to(one))  # a user's own choice
    return view.with_more(shown=filter(None, (job.interfaces,)), masked=hidden)


def _interface_path(job: Job) -> dict[str, str]:
    """The variable with which the program finds the interfaces of its exercise before others of the same name."""
    return {PATH_VARIABLE: path_with(job.interfaces)} if job.interfaces else {}


def _user(job: Job) -> int:
    """Whom the submission runs as: a command of root's own stays root where others cannot get at what it names."""
    if job.command:
        for path in map(Path, (job.folder, *file_view.named_paths(job.command[1:], job.folder))):
            around = (path, *path.parents) if path.is_dir() else path.parents
            if not all(place.stat().st_mode & stat.S_IXOTH for place in around):
                return 0
    return job.user


def _others(job: Job) -> int:
    """Tasks the kernel counts with the submission's: before Linux 5.14 all of the user's, in any namespace.

    With what others may start meanwhile, such as gradings side by side: a thread that cannot be started because of them
    would be told as the submission's fault. What it may have itself the init process sees to.
    """
    version = tuple(int(part) for part in os.uname().release.split(".")[:2])
    counted_apart = job.isolation.processes and version >= _COUNTS_BY_NAMESPACE
    return 0 if counted_apart else tree.tasks_of_user(os.getuid()) + _STARTED_MEANWHILE
