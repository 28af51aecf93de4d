"""`lab.send_goal` and its twin for programs; light, as rclpy is imported when they are first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.lab.awaiting import to_be_awaited
from course_kit.lab.singleton import current

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.goals import AskedGoal, Goal, Sending
    from course_kit.ros.messages import ActionType, Message


@to_be_awaited("lab.send_goal")
async def send_goal(  # noqa: PLR0913 - four of them are options, by name
    action: str,
    action_type: ActionType,
    goal: Message = None,
    /,
    *,
    timeout: float = 5.0,
    on_feedback: Callable[[Message], object] | None = None,
    on_result: Callable[[Goal], object] | None = None,
    **fields: object,
) -> Goal:
    """Send a goal and wait until it is accepted or rejected: `await lab.send_goal("/fibonacci", Fibonacci, order=5)`.

    Args:
        action: the action's name.
        action_type: its class.
        goal: a ready goal message instead of `fields`.
        timeout: seconds until the server must have answered; an action that is not on the graph is waited for 2 s.
        on_feedback: called with each feedback message, on the lab's thread.
        on_result: called with the `Goal` when it has ended, on the lab's thread.
        fields: the goal's fields; a dict for a message inside it.

    Returns:
        the goal: `accepted`, `status`, `feedback`, `await goal.result()`, `await goal.cancel()`, and
        `async for feedback in goal`. A rejected goal is one with `accepted` False.

    Raises:
        ActionNotFoundError: no server of this name and type.
        FieldError: no such field, or a value it cannot take.
        NoAnswerError: the server neither accepted nor rejected it in time, or went away.
    """
    from course_kit.lab.calls import call_async
    from course_kit.lab.goals import AskedGoal

    asked = AskedGoal(goal, fields, timeout, on_feedback, on_result)
    sent: Goal = await call_async(_sending("lab.send_goal()", action, action_type, asked))
    return sent


def send_goal_blocking(  # noqa: PLR0913 - the same
    action: str,
    action_type: ActionType,
    goal: Message = None,
    /,
    *,
    timeout: float = 5.0,
    on_feedback: Callable[[Message], object] | None = None,
    on_result: Callable[[Goal], object] | None = None,
    **fields: object,
) -> Goal:
    """See `send_goal`; this is the same for programs, and so are `goal.result_blocking()` and `cancel_blocking()`."""
    from course_kit.lab.calls import call_blocking
    from course_kit.lab.goals import AskedGoal

    asked = AskedGoal(goal, fields, timeout, on_feedback, on_result)
    sent: Goal = call_blocking(_sending("lab.send_goal_blocking()", action, action_type, asked))
    return sent


def _sending(verb: str, action: str, action_type: ActionType, asked: AskedGoal) -> Sending:
    from course_kit.lab.goals import Sending

    engine = current().engine
    engine.not_in_callback(verb)
    return Sending(engine, action, action_type, asked)
