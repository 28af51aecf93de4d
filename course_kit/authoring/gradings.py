"""Programs graded side by side, by the pool that grades a class."""

from __future__ import annotations

import tempfile
from concurrent.futures import Future
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.executors import LocalExecutor
from course_kit.grading.engine import GradingRequest, unreadable
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading.file_copy import Copy
from course_kit.grading.reading.reader import Reader
from course_kit.grading.sandbox import needs
from course_kit.process import Closable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.authoring.corpus import ProofSubmission
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.report import Report


class Gradings(Closable):
    """The pool, and what reads programs for it. Use it in a `with` statement."""

    def __init__(self, exercises: Sequence[Exercise], workers: int = 0) -> None:
        for one in exercises:
            needs.require_machine(one.limits)
        self._exercises = {one.id: one for one in exercises}
        self._folder = tempfile.TemporaryDirectory(prefix="course-kit-gradings-")
        self._reader = Reader()
        graders = [one.grader for one in exercises if one.grader]
        self._pool = LocalExecutor(workers or None, graders, [one.limits for one in exercises])

    def close(self) -> None:
        """End it; what is under way is given up."""
        self._pool.close()
        self._reader.close()
        self._folder.cleanup()

    def begin(self, submission: ProofSubmission, seed: int) -> Future[Report]:
        """Have a submission of a proof set graded some time."""
        if submission.changes:
            return self.begin_text(submission.exercise, submission.text(), seed)
        return self.begin_file(submission.exercise, submission.path, seed)

    def begin_text(self, exercise_id: str, program: str, seed: int, *, first_failure: bool = False) -> Future[Report]:
        """Have a program graded that is in no file."""
        path = Path(self._folder.name) / f"{exercise_id}.py"
        path.write_text(program, encoding="utf-8")
        return self.begin_file(exercise_id, path, seed, first_failure=first_failure)

    def begin_file(self, exercise_id: str, path: Path, seed: int, *, first_failure: bool = False) -> Future[Report]:
        """Have a file graded, with `first_failure` until the first check that fails."""
        exercise = self._exercises[exercise_id]
        try:
            with Copy(path) as copy:
                text = self._reader.read(copy, exercise)
        except UnreadableError as problem:
            future: Future[Report] = Future()
            future.set_result(unreadable(exercise, path.name, str(problem)))
            return future
        return self._pool.submit(GradingRequest(exercise, text, path.name, seed, first_failure=first_failure))
