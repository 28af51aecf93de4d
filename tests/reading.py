"""Reads a submission as the grader does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.reading import Reader, copy_file

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.model.submission import Submission


def read(path: Path, exercise_id: str) -> Submission:
    with copy_file(path) as copy, Reader() as reader:
        return reader.read(copy, load_exercise(exercise_id))
