"""Has programs graded side by side."""

from __future__ import annotations

import tempfile
import time
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.executors import Local
from course_kit.grading import needs
from course_kit.grading.engine import Task
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.grading.submission import Copy, UnreadableError
from course_kit.process.closing import Closing

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from concurrent.futures import Future

    from course_kit.grading.exercise import Exercise
    from course_kit.grading.report import Report

_AHEAD = 2  # programs given to the executor for each of its slots
_LISTEN_S = 0.25  # how often a wait for verdicts looks at the clock
_TINY = 1e-6  # points


@dataclass(frozen=True)
class Request:
    """A program to grade.

    Attributes:
        name: what it is called.
        source: its text.
        seed: what the checks draw from.
        first_failure: stop at the first failed check.
        repeat: the how manieth time, from 0; verdicts of other times are not taken for it.
    """

    name: str
    source: str
    seed: int
    first_failure: bool = False
    repeat: int = 0


@dataclass(frozen=True)
class Verdict:
    """What a grader has made of a program.

    Attributes:
        full_marks: whether it has got them.
        failed: the ids of the checks it has failed; with `Request.first_failure` there is one at most.
        problem: why it could not be graded; empty when it was.
        said: what the report says of the first failed check.
        duration_s: seconds on the wall.
    """

    full_marks: bool
    failed: tuple[str, ...] = ()
    problem: str = ""
    said: str = ""
    duration_s: float = 0.0

    @property
    def shown(self) -> str:
        """In a few words."""
        if self.problem:
            return f"not graded ({self.problem})"
        return "full marks" if self.full_marks else f"{' and '.join(self.failed) or 'no check'} failed"


class ProgramGrader(Closing):
    """The workers. Use it in a `with` statement."""

    def __init__(self, exercise: Exercise, workers: int = 0) -> None:
        """Start the workers.

        Args:
            exercise: what is graded.
            workers: how many gradings run at a time; as many as fit this machine when 0.

        Raises:
            GradingError: grading is not possible here.
        """
        needs.require(exercise.limits)
        self._exercise = exercise
        self._folder = tempfile.TemporaryDirectory(prefix="course-kit-prove-")
        self._reader = Reader()
        self._executor = Local(workers or None, [exercise.grader] if exercise.grader else [], [exercise.limits])

    def close(self) -> None:
        """End them; what is under way is given up."""
        self._executor.close()
        self._reader.close()
        self._folder.cleanup()

    def grade(
        self, requests: Sequence[Request], begin_until: float | None = None, end_by: float | None = None
    ) -> Iterator[tuple[Request, Verdict]]:
        """Grade programs, yielding each verdict as it comes.

        Args:
            requests: the programs.
            begin_until: when nothing more is begun, by the monotonic clock; None for no such time.
            end_by: when no verdict is waited for any more.

        Raises:
            GradingError: grading has become impossible.
        """
        waiting = iter(requests)
        under_way: dict[Future[Report], Request] = {}
        more = True
        while more or under_way:
            now = time.monotonic()
            if more and begin_until is not None and now > begin_until:
                more = False
                under_way = {future: one for future, one in under_way.items() if not future.cancel()}
            if under_way and end_by is not None and now > end_by:
                return
            while more and len(under_way) < _AHEAD * self._executor.slots:
                following = next(waiting, None)
                if following is None:
                    more = False
                else:
                    under_way[self._executor.submit(self._task(following))] = following
            done, _ = wait(under_way, _LISTEN_S, FIRST_COMPLETED)
            for future in done:
                yield under_way.pop(future), verdict_of(future.result())

    def report(self, request: Request) -> Report:
        """Grade one program, and wait for its report.

        Raises:
            GradingError: it cannot be read.
        """
        return self._executor.submit(self._task(request)).result()

    def _task(self, request: Request) -> Task:
        path = Path(self._folder.name) / f"{self._exercise.id}.py"
        path.write_text(request.source, encoding="utf-8")
        try:
            with Copy(path) as copy:
                text = self._reader.read(copy, self._exercise)
        except UnreadableError as problem:
            raise GradingError(f"{request.name} cannot be graded: {problem}") from None
        return Task(self._exercise, text, request.name, request.seed, first_failure=request.first_failure)


def verdict_of(report: Report) -> Verdict:
    """What a report comes to."""
    failed = [check for check in report.checks if check.status == "failed"]
    return Verdict(
        full_marks=report.status == "graded" and report.score >= report.max_score - _TINY,
        failed=tuple(check.id for check in failed),
        problem=report.problem if report.status in ("error", "unreadable") else "",
        said=failed[0].told if failed else "",
        duration_s=round(report.duration_s, 3),
    )
