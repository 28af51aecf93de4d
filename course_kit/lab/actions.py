"""Actions behind a notebook: a crash told in short, and no reply lost.

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

from course_kit.lab.executor import Turn

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.patches import Patches


def install(patches: Patches, crashed: Callable[[BaseException, Turn], None]) -> None:
    """Have `crashed` told of execute callbacks that raise, and replies kept; `patches` takes it back."""
    _tell_of_crashes(patches, crashed)
    sending = threading.RLock()
    for method in ("send_goal_async", "_cancel_goal_async", "_get_result_async", "take_data"):
        _hold(patches, ActionClient, method, sending)


def _hold(patches: Patches, owner: Any, method: str, lock: Any) -> None:
    original = getattr(owner, method)

    @functools.wraps(original)
    def held(*arguments: Any, **options: Any) -> Any:
        with lock:
            return original(*arguments, **options)

    patches.set(owner, method, held)


def _tell_of_crashes(patches: Patches, crashed: Callable[[BaseException, Turn], None]) -> None:
    register = ActionServer.register_execute_callback

    def register_guarded(server: Any, execute_callback: Any) -> None:
        async def execute(goal_handle: Any) -> Any:
            begun = time.monotonic()
            try:
                if inspect.iscoroutinefunction(execute_callback):
                    return await execute_callback(goal_handle)
                return execute_callback(goal_handle)
            except Exception as error:  # noqa: BLE001 - whatever the learner's code raises
                crashed(error, Turn(None, server._node, begun))  # noqa: SLF001 - rclpy has no other way to it
                if goal_handle.is_active:
                    goal_handle.abort()
                return server._action_type.Result()  # noqa: SLF001

        register(server, execute if callable(execute_callback) else execute_callback)

    patches.set(ActionServer, "register_execute_callback", register_guarded)
