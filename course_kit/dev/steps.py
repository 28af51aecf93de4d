"""Runs commands one after the other, each with a deadline, and leaves nothing of them behind."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING

from course_kit.process import tree
from course_kit.process.child import Child
from course_kit.process.parent import adopt_orphans
from course_kit.process.signals import Ladder

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from typing_extensions import Self

_GRACE_S = 60.0  # pytest ends its kernels, an installer its own children; on a busy machine that takes long
_MORE_S = 5.0


@dataclass(frozen=True)
class CommandStep:
    """A command to be run.

    Attributes:
        name: what people call it.
        command: the words of the command.
        deadline_s: seconds after which it is ended and has failed.
        check: tells what is wrong with what it has printed on stdout, or nothing.
    """

    name: str
    command: Sequence[str]
    deadline_s: float
    check: Callable[[str], str] = lambda _: ""


@dataclass(frozen=True)
class StepResult:
    """How a step went.

    Attributes:
        step: its name.
        problem: why it failed; empty if it did not.
        seconds: how long it took.
    """

    step: str
    problem: str
    seconds: float

    @property
    def failed(self) -> bool:
        """Whether it did."""
        return bool(self.problem)


class StepRunner:
    """Runs steps; at its end, also by Ctrl-C, none of their processes is left. Use it in a `with` statement.

    It ends every process below this one, so nothing else may have been started from here.
    """

    def __enter__(self) -> Self:
        adopt_orphans()  # so that what a step has detached can be ended, too
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end_all()

    def run(self, step: CommandStep, folder: Path, environ: Mapping[str, str]) -> StepResult:
        """Run a step and say how it went; what it has printed is shown when it failed.

        Args:
            step: what to run.
            folder: its working directory.
            environ: its environment.
        """
        began = time.monotonic()
        # Files, not pipes: those would stay open for as long as something it has detached lives.
        with tempfile.TemporaryFile() as stdout, tempfile.TemporaryFile() as stderr:
            problem = _ending(step, folder, environ, stdout, stderr)
            output = _text(stdout)
            problem = problem or step.check(output)
            seconds = time.monotonic() - began
            print(
                f"course:   {step.name}: {f'FAILED: {problem}' if problem else 'passed'} ({seconds:.0f} s)", flush=True
            )
            if problem:
                print(f"{output}\n{_text(stderr)}", flush=True)
        return StepResult(step.name, problem, seconds)

    def end_all(self) -> None:
        """Kill whatever the steps so far have left running."""
        tree.end_descendants()


def _ending(step: CommandStep, folder: Path, environ: Mapping[str, str], stdout: IO[bytes], stderr: IO[bytes]) -> str:
    """Run it; why it has failed, or nothing."""
    child = Child(step.command, folder=folder, environ=environ, stdout=stdout, stderr=stderr)
    code = None
    try:
        code = child.wait(step.deadline_s)
    finally:
        if code is None:
            child.end(Ladder(_GRACE_S, _MORE_S, _MORE_S))
            tree.end_descendants()
    if code is None:
        return f"it had not ended after {step.deadline_s:g} s"
    return f"exit code {code}" if code else ""


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode("utf-8", errors="replace")
