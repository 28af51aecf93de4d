"""Reads a submission as the grader does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.model.submission import Copy, Submission
from course_kit.grading.reading.reader import Reader

if TYPE_CHECKING:
    from pathlib import Path


def read(path: Path, exercise_id: str) -> Submission:
    with Copy(path) as copy, Reader() as reader:
        return reader.read(copy, load_exercise(exercise_id))
