"""Actions behind a notebook: execute callbacks do not hold up anybody, a crash is told in short, no reply is lost.

A goal is executed on a thread of its own (see `execution`).

An exception in an execute callback is caught by rclpy itself, which prints the whole traceback and aborts the goal
with an empty result; here it is told like any other, and the goal ends the same way.

A goal sent from a cell may be answered before rclpy's action client has noted that it waits for an answer (issue
1123 of rclpy), because another thread takes the answer. Here taking waits for the sending to be complete.
"""

from __future__ import annotations

import functools
import inspect
import threading
import time
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionClient, ActionServer

from course_kit.lab.errors import CallbackStopped
from course_kit.lab.recording.hooks import WrongResultError
from course_kit.lab.runtime.executor import Turn

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from rclpy.action.server import ServerGoalHandle

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.runtime.execution import Execute, Executions
    from course_kit.ros.messages import Message


def keep_replies(patches: Patches) -> None:
    """Have a client note what it waits for before it takes any reply; `patches` takes it back."""
    sending = threading.RLock()
    for method in ("send_goal_async", "_cancel_goal_async", "_get_result_async", "take_data"):
        _hold(patches, ActionClient, method, sending)


def _hold(patches: Patches, owner: Any, method: str, lock: AbstractContextManager[bool]) -> None:
    original = getattr(owner, method)

    @functools.wraps(original)
    def held(*arguments: Any, **options: Any) -> Any:
        with lock:
            return original(*arguments, **options)

    patches.set(owner, method, held)


def execute_apart(patches: Patches, executions: Executions, crashed: Callable[[BaseException, Turn], None]) -> None:
    """Have goals executed by `executions`, and `crashed` told of what raises."""
    execute_goal = ActionServer._execute_goal  # noqa: SLF001 - all of a server's goals pass here, however they are begun

    async def execute_goal_apart(
        server: ActionServer, execute_callback: Execute, goal_handle: ServerGoalHandle
    ) -> None:
        node = server._node  # noqa: SLF001 - rclpy has no other way to it
        begun = time.monotonic()

        async def execute(handle: ServerGoalHandle) -> Message:
            try:
                return await _result(executions, server, execute_callback, handle)
            except CallbackStopped:
                raise
            except BaseException as error:  # noqa: BLE001 - whatever the learner's code raises
                crashed(error, Turn(None, node, begun, execute_callback))
                if handle.is_active:
                    handle.abort()
                return server.action_type.Result()

        await execute_goal(server, execute, goal_handle)

    patches.set(ActionServer, "_execute_goal", execute_goal_apart)


async def _result(
    executions: Executions, server: ActionServer, execute_callback: Execute, handle: ServerGoalHandle
) -> Message:
    """What an execute callback returns."""
    if executions.runs(server._node):  # noqa: SLF001 - as above
        result = await executions.run(server, execute_callback, handle)
    elif inspect.iscoroutinefunction(execute_callback):
        result = await execute_callback(handle)
    else:
        result = execute_callback(handle)
    if not isinstance(result, server.action_type.Result):
        raise WrongResultError(result, server.action_type)
    return result
