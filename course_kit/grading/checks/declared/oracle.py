"""Asks the exercise's own solution what is right, before the submission is started.

It is asked with the very inputs that the submission will get, in a sandbox of its own, and has ended before the
submission begins: the two never run at the same time, so that neither can see or reach the other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.checks.check import Failed
from course_kit.grading.checks.declared import acting, goals, services, starting, topics
from course_kit.grading.checks.declared.messages import check_asks_the_solution
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration

_DEADLINE_S = 25.0  # for all its answers
_ASK: dict[str, Callable[[CheckContext, Declaration, Around], list[Any]]] = {
    "answers": services.ask,
    "topic_answers": topics.ask,
    "parameter_acts": acting.ask,
    "goal_succeeds": goals.ask,
}


def ask(context: CheckContext, around: Around) -> None:
    """Have the solution answer the inputs of all checks that compare with it.

    Args:
        context: of the grading, which has not begun.
        around: the exercise; keeps the answers.

    Raises:
        GradingError: the solution is not there, or does not answer.
    """
    asking = [check for check in around.declarations if check_asks_the_solution(check)]
    if not asking:
        return
    if not context.job.solution:
        raise GradingError("This exercise compares with its own solution, which is not here.")
    with context.solution(_DEADLINE_S):
        try:
            starting.await_up(context, around)
            for check in asking:
                around.answers[check.id] = _ASK[check.kind](context, check, around)
        except Failed as failed:
            message = f"The exercise's own solution does not answer what the checks ask: {failed.message}"
            raise GradingError(f"{message} Grade the solution itself, and mend it.") from None
