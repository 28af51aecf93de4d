"""The text of an exercise's solution, for those checks that compare with what it answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.checks.declared.messages import check_asks_the_solution
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from course_kit.grading.exercise import Exercise


def are_asked(task: Exercise) -> bool:
    """Whether a check of an exercise compares with what its solution answers."""
    return any(map(check_asks_the_solution, task.declared))


def text_for(task: Exercise) -> str:
    """The text of an exercise's solution; empty where no check asks it.

    Raises:
        GradingError: it is not there, as in a student's edition.
    """
    if not are_asked(task):
        return ""
    try:
        return task.solution.read_text(encoding="utf-8")
    except (OSError, ValueError) as problem:
        message = f"The exercise {task.id} compares with its own solution, and {task.solution} cannot be read"
        raise GradingError(f"{message}: {problem}.") from None
