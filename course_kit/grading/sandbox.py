"""A submission's cage: how it is started, watched and ended.

Three processes stand between the grader and the submission, each a fork of the warm one, so that nothing is
loaded twice: the *gate* enters the namespaces and waits; the *guard*, process 1 of the new PID namespace,
arranges the files, counts, and enforces what the kernel does not; the *program* has given up every privilege
and runs the learner's code (see `runner`). When the guard ends, the kernel ends all the program has started.

Where there are no namespaces the same three run without them: every kept descendant is adopted
(PR_SET_CHILD_SUBREAPER) and killed at the end, however often it has forked or called setsid.

What this is not is said in LIMITS.md, the page for users: a boundary against kernel bugs; nor, without namespaces,
against a program that signals, traces or talks to other processes of the same user. With namespaces a submission can
still read every file its user can read (but for hidden folders) and connect to sockets that are files.
"""

from __future__ import annotations

import os
import shutil
import signal
import tempfile
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.grading import guard, namespaces, processes
from course_kit.grading.isolation import enter_processes

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from course_kit.grading.isolation import Isolation
    from course_kit.grading.limits import Limits
    from course_kit.grading.runner import Program


@dataclass(frozen=True)
class Cell:
    """Under which conditions a program runs.

    Attributes:
        limits: what it may use.
        isolation: the walls known to stand on this machine.
        environment: variables to set for the program, beside HOME, TMPDIR and PWD.
        scratch: where its scratch directory is made.
        priority: the nice value to run at.
        others: the user's other processes and threads where the kernel counts them together with the program's.
        hidden: folders that appear empty to it, where its files are walled off.
    """

    limits: Limits
    isolation: Isolation
    scratch: str
    environment: Mapping[str, str] = field(default_factory=dict)
    hidden: tuple[str, ...] = ()
    priority: int = 0
    others: int = 0


@dataclass
class Streams:
    """The ends of the pipes of one sandbox: one set for this side, the other for the inside."""

    stdout: int
    stderr: int
    status: int
    evidence: int
    control: int

    def close(self) -> None:
        """Close all of them, once."""
        for name in ("stdout", "stderr", "status", "evidence", "control"):
            descriptor = getattr(self, name)
            if descriptor >= 0:
                os.close(descriptor)
                setattr(self, name, -1)


class Sandbox:
    """One running submission. The caller must have one thread, and have called `adopt_orphans`."""

    def __init__(self, program: Program, cell: Cell) -> None:
        """Start `program`. Returns at once; whether it starts well is seen in what comes out of `streams`."""
        self._folder = tempfile.mkdtemp(prefix="course-kit-", dir=cell.scratch or None)
        self.streams, inside = _pipes()
        self._gate = os.fork()
        if self._gate == 0:
            try:
                self.streams.close()
                _gate(program, cell, self._folder, inside)
            finally:
                os._exit(guard.FAILED)
        inside.close()

    def ask(self, what: bytes) -> None:
        """Ask the guard for `guard.SAMPLE` or `guard.STACKS`; the answer comes on its stream."""
        with suppress(OSError):  # it has ended; so its stream says
            os.write(self.streams.control, what)

    def end(self, keep: Container[int]) -> None:
        """Kill all that was started; returns when it is dead and its scratch directory gone.

        Args:
            keep: other children of this process, which are to live on.
        """
        with suppress(ProcessLookupError):
            os.kill(self._gate, signal.SIGKILL)
        processes.end_descendants(keep)
        shutil.rmtree(self._folder, ignore_errors=True)


def _pipes() -> tuple[Streams, Streams]:
    pipes = [os.pipe() for _ in range(5)]
    (stdout, stderr, status, evidence, control) = pipes
    ours = Streams(stdout[0], stderr[0], status[0], evidence[0], control[1])
    inside = Streams(stdout[1], stderr[1], status[1], evidence[1], control[0])
    for descriptor in (ours.stdout, ours.stderr, ours.status, ours.evidence, ours.control):
        os.set_blocking(descriptor, False)
    return ours, inside


def _gate(program: Program, cell: Cell, folder: str, inside: Streams) -> None:
    namespaces.die_with_parent()
    if cell.isolation.processes:
        enter_processes()
        namespaces.die_with_parent()  # entering a user namespace has cleared it
    child = os.fork()
    if child == 0:
        try:
            guard.main(program, cell, folder, inside)
        finally:
            os._exit(guard.FAILED)
    inside.close()
    os.waitpid(child, 0)
    os._exit(0)
