"""Grades one submission for a platform's autograder, which hands over a folder of whatever was handed in."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.intake.choosing import Chooser
from course_kit.classroom.intake.layouts import HandIn
from course_kit.classroom.intake.listing import FOLDER, Item
from course_kit.classroom.intake.sources import CopiedFolder, OpenedSources
from course_kit.classroom.records import Entry, GradeRecord
from course_kit.grading import engine
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.grading.reading import Reader

if TYPE_CHECKING:
    from course_kit.grading.model.report import Report

_STUDENT = "submission"  # there is only one, and the platform knows who


def grade_path(
    exercise_id: str, path: Path, *, seed: int | None = None, require_isolation: bool = False
) -> GradeRecord:
    """Grade a file, or what is found in a folder by the rules of a class's intake."""
    exercise = load_exercise(exercise_id)
    if not path.is_dir():
        report = engine.grade(exercise.id, path, seed=seed, require_isolation=require_isolation)
        return _record(exercise, path.name, report)
    with tempfile.TemporaryDirectory(prefix="submission-") as made:
        found = _find(path.resolve(), exercise, Path(made, "copied"))
        if found is None:
            why = "There is no program for this exercise in what was handed in. "
            report = engine.report_unreadable(
                exercise, path.name, f"{why}Hand in {exercise.starter} or {exercise.notebook}."
            )
            return _record(exercise, path.name, report)
        report = engine.grade(exercise.id, found, seed=seed, require_isolation=require_isolation)
        return _record(exercise, found.name, report)


def _record(exercise: Exercise, source: str, report: Report) -> GradeRecord:
    """The result as a class's exports take it."""
    if report.status == "error":
        raise GradingError(f"The grader itself failed, which is no fault of the submission: {report.problem}")
    entry = Entry("", exercise.id, source)
    return GradeRecord(entry, "", 0, report.seed, report.to_mapping(), title=exercise.title, isolation=report.isolation)


def _find(folder: Path, exercise: Exercise, workspace: Path) -> Path | None:
    """The file to grade, as a copy, or None."""
    unit = HandIn(Item(folder.name, FOLDER), _STUDENT)
    copied = CopiedFolder(folder.parent, workspace)
    with Reader() as reader:
        chooser = Chooser(OpenedSources(workspace, copied, units=(unit,), is_copy=True), [exercise], reader)
        chooser.take(_STUDENT, [unit])
    return workspace / chooser.entries[0].source if chooser.entries else None
