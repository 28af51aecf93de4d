"""The gradebook of a class run that has ended, out of its output folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom import run_note
from course_kit.classroom.gradebook import Gradebook
from course_kit.classroom.records import Records
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path


def gradebook(out: Path) -> Gradebook:
    """The results in a folder, without what was handed in."""
    records = tuple(sorted(Records(out), key=lambda one: (one.entry.student, one.entry.exercise)))
    if not records:
        raise GradingError(f"{out} holds no results of a class. Name the folder that --out named.")
    found = sorted(
        (run_note.exercise_of(out, one) for one in {record.entry.exercise for record in records}),
        key=lambda one: one.order,
    )
    return Gradebook(tuple(found), records)
