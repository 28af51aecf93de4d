"""Programs graded side by side, by the pool that grades a class."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from course_kit.grading import pool
from course_kit.grading.engine import GradingRequest, report_unreadable
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import Reader, copy_file
from course_kit.grading.sandbox import needs
from course_kit.process import Closable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from course_kit.authoring.corpus import ProofSubmission
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.report import Report

Thing = TypeVar("Thing")


class Gradings(Closable):
    """The pool, and what reads programs for it. Use it in a `with` statement."""

    def __init__(self, exercises: Sequence[Exercise], workers: int | None = None) -> None:
        for exercise in exercises:
            needs.require_machine(exercise.limits)
        self._exercises = {exercise.id: exercise for exercise in exercises}
        self._folder = tempfile.TemporaryDirectory(prefix="course-kit-gradings-")
        self._reader = Reader()
        self._pool = pool.start_pool(exercises, workers)

    def close(self) -> None:
        """End it; what is under way is given up."""
        self._pool.close()
        self._reader.close()
        self._folder.cleanup()

    def grade_all(self, requests: Iterable[tuple[Thing, GradingRequest | Report]]) -> Iterator[tuple[Thing, Report]]:
        """Grade; each report comes out with its thing as soon as it is there."""
        return pool.grade_all(self._pool, requests)

    def request_for(self, submission: ProofSubmission, seed: int) -> GradingRequest | Report:
        """How to grade a submission of a proof set; the report of one that cannot be read."""
        program = submission.texts() if submission.files or submission.changes else submission.path
        return self.request_for_program(submission.exercise, program, seed)

    def request_for_program(
        self, exercise_id: str, program: Path | Mapping[str, str], seed: int, *, first_failure: bool = False
    ) -> GradingRequest | Report:
        """How to grade a file or texts by their files' names, with `first_failure` until the first check that fails."""
        exercise = self._exercises[exercise_id]
        if not isinstance(program, Path):
            with tempfile.TemporaryDirectory(dir=self._folder.name) as folder:
                for name, source in program.items():
                    Path(folder, name).write_text(source, encoding="utf-8")
                path = Path(folder) if exercise.files else Path(folder, *program)
                return self.request_for_program(exercise_id, path, seed, first_failure=first_failure)
        try:
            with copy_file(program, several=bool(exercise.files)) as copy:
                text = self._reader.read(copy, exercise)
        except UnreadableError as problem:
            return report_unreadable(exercise, program.name, str(problem))
        return GradingRequest(exercise, text, program.name, seed, first_failure=first_failure)
