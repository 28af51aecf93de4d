"""Reports while execute callbacks of goals run; see `spans`."""

from __future__ import annotations

import functools
import inspect
from typing import TYPE_CHECKING, Any

from course_kit.lab.recording.action_hooks import where_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.action import ActionServer
    from rclpy.action.server import ServerGoalHandle

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.recording.hooks import MessageHooks
    from course_kit.lab.recording.spans import CallbackSpans, Where


def hook_execution(patches: Patches, hooks: MessageHooks) -> None:
    """Have execute callbacks of goals reported, wherever they run."""
    from rclpy.action import ActionServer

    execute_goal = ActionServer._execute_goal  # noqa: SLF001 - all of a server's goals pass here

    async def execute_goal_seen(
        server: ActionServer, execute_callback: Callable[..., Any], goal_handle: ServerGoalHandle
    ) -> None:
        where = where_of(server)
        seen = _reported(execute_callback, where, hooks.spans) if hooks.events and where else execute_callback
        await execute_goal(server, seen, goal_handle)

    patches.set(ActionServer, "_execute_goal", execute_goal_seen)


def _reported(callback: Callable[..., Any], where: Where, spans: CallbackSpans) -> Callable[..., Any]:
    if inspect.iscoroutinefunction(callback):

        @functools.wraps(callback)
        async def execute_in_steps(goal_handle: ServerGoalHandle) -> Any:
            return await spans.steps(callback(goal_handle), where, "goal")

        return execute_in_steps

    @functools.wraps(callback)
    def execute(goal_handle: ServerGoalHandle) -> Any:
        number = spans.begin(where, "goal")
        failed = True
        try:
            result = callback(goal_handle)
            failed = False
        finally:
            spans.end(number, where, failed=failed)
        return result

    return execute
