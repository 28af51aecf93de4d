"""Grades one submission for a platform's autograder, which hands over a folder of whatever was handed in."""

from __future__ import annotations

import secrets
import shutil
import stat
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.intake import collecting
from course_kit.classroom.intake.listing import FOLDER, Item, why_a_tools
from course_kit.classroom.records import Entry, GradeRecord
from course_kit.grading import engine
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Exercise, load_exercise

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_kit.grading.model.report import Report

_STUDENT = "submission"  # there is only one, and the platform knows who


def grade_path(
    exercise_id: str, path: Path, *, seed: int | None = None, require_isolation: bool = False
) -> GradeRecord:
    """Grade a file, or what is found in a folder by the rules of a class's intake."""
    exercise = load_exercise(exercise_id)
    if seed is None:  # drawn here, for the result to tell it
        seed = secrets.randbits(31) if exercise.seed is None else exercise.seed
    if not path.is_dir():
        report = engine.grade(exercise.id, path, seed=seed, require_isolation=require_isolation)
        return _record(exercise, path.name, report, seed)
    with tempfile.TemporaryDirectory(prefix="submission-") as made:
        handed_over = Path(made, "handed_over")
        _copy(path, handed_over / _STUDENT)
        found = _find(handed_over, exercise, Path(made, "unpacked"))
        if found is None:
            why = "There is no program for this exercise in what was handed in. "
            report = engine.unreadable(exercise, path.name, f"{why}Hand in {exercise.starter} or {exercise.notebook}.")
            return _record(exercise, path.name, report, seed)
        report = engine.grade(exercise.id, found, seed=seed, require_isolation=require_isolation)
        return _record(exercise, found.name, report, seed)


def _record(exercise: Exercise, source: str, report: Report, seed: int) -> GradeRecord:
    """The result as a class's exports take it."""
    if report.status == "error":
        raise GradingError(f"The grader itself failed, which is no fault of the submission: {report.problem}")
    entry = Entry("", exercise.id, source)
    return GradeRecord(entry, "", 0, seed, report.to_mapping(), title=exercise.title, isolation=report.isolation)


def _find(handed_over: Path, exercise: Exercise, workspace: Path) -> Path | None:
    """The file to grade, or None."""
    if not any((handed_over / _STUDENT).iterdir()):
        return None
    found = collecting.collect_submissions(handed_over, [exercise], workspace, "folders")
    return found.root / found.entries[0].source if found.entries else None


def _copy(source: Path, target: Path) -> None:
    """Copy what a student handed in, but for what tools have made, and pipes and the like, which are nobody's work."""
    shutil.copytree(source, target, symlinks=True, ignore=_of_tools, copy_function=_copy_file)


def _of_tools(folder: str, names: Iterable[str]) -> set[str]:
    return {name for name in names if Path(folder, name).is_dir() and why_a_tools(Item(name, FOLDER))}


def _copy_file(source: str, target: str) -> None:
    if stat.S_ISREG(Path(source).lstat().st_mode):
        shutil.copy2(source, target)
