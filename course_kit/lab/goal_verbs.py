"""`lab.send_goal` and its twin for programs; light, as rclpy is imported when they are first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.lab.singleton import current

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.goals import AskedGoal, Goal
    from course_kit.ros.messages import ActionType, Message


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
    return await current().send_goal(action, action_type, _asked_goal(goal, fields, timeout, on_feedback, on_result))


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
    """The same as `send_goal` for programs; so are `goal.result_blocking()` and `goal.cancel_blocking()`.

    Args:
        action: as for `send_goal`.
        action_type: as for `send_goal`.
        goal: as for `send_goal`.
        timeout: as for `send_goal`.
        on_feedback: as for `send_goal`.
        on_result: as for `send_goal`.
        fields: as for `send_goal`.
    """
    asked = _asked_goal(goal, fields, timeout, on_feedback, on_result)
    return current().send_goal_blocking(action, action_type, asked)


def _asked_goal(
    goal: Message,
    fields: dict[str, object],
    timeout: float,
    on_feedback: Callable[[Message], object] | None,
    on_result: Callable[[Goal], object] | None,
) -> AskedGoal:
    from course_kit.lab.goals import AskedGoal

    return AskedGoal(goal, fields, timeout, on_feedback, on_result)
