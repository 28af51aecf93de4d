"""What to do after an exercise was passed."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.learner import course_list

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.exercise import Exercise


def next_step(passed: str, root: Path | None = None) -> str:
    """One sentence or two: the next lesson and the next exercise. An exercise follows the lesson of its number.

    After a drill it is the next drill that is not solved yet.

    Args:
        passed: the id of the exercise.
        root: the course's folder, or a copy of it; the one this package runs from when None.
    """
    drills, _ = course_list.rows(practice=True)
    if (drill := next((row.task for row in drills if row.task.id == passed), None)) is not None:
        left = next((row.task.id for row in drills if not row.known.passed and row.task is not drill), None)
        way = f"Next: {environment.command()} drills {left}." if left else "That was the last drill."
        return f"{way}{_comparison(drill)}"
    root = root or environment.course_files()
    tasks = _in_order()
    number = next((task.order for task in tasks if task.id == passed), 0)
    following = next((task for task in tasks if task.order > number), None)
    lessons = sorted((root / "notebooks").glob(f"{number + 1:02}_*.ipynb")) if root is not None else []
    steps = [f"lesson {number + 1}, notebooks/{lessons[0].name}"] if lessons else []
    if following is not None:
        steps.append(f"exercise {following.order}, {following.id}")
    way = f"Next: {'; then '.join(steps)}." if steps else "That is the last exercise."
    return f"{way}{_comparison(next((task for task in tasks if task.id == passed), None))}"


def _comparison(task: Exercise | None) -> str:
    """How to see our solution, where there is one; a student edition has none."""
    if task is None or not task.solution.is_file():
        return ""
    where = f" --exercises {shlex.quote(str(task.folder))}" if exercise_folders.is_added(task.folder) else ""
    return f" Compare yours with ours: {environment.command()} solution {task.id}{where}"


def _in_order() -> list[Exercise]:
    found = [task for name in exercise.ids() if (task := _load(name)) is not None]
    return sorted(found, key=lambda task: task.order)


def _load(name: str) -> Exercise | None:
    try:
        return exercise.load(name)
    except GradingError:  # one that is being written
        return None
