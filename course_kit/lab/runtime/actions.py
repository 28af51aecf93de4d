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

from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.executors import await_or_execute

from course_kit.lab.errors import CallbackStopped
from course_kit.lab.recording.hooks import WrongResultError
from course_kit.lab.runtime.executor import Turn

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.action.server import ServerGoalHandle

    from course_kit.lab.overrides.patches import Patches
    from course_kit.ros.messages import Message

    Instead = Callable[[ActionServer, Any], tuple[str, Callable[[], object]]]  # what follows, and what brings it about
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from course_kit.lab.runtime.execution import Execute, Executions


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


_REJECTED = "The goal is rejected"
_REFUSED = "The request to cancel is rejected"
_ABORTED = "The goal is aborted with an empty result"
_ALREADY = "The goal is executed all the same"
_IN_A_PROGRAM = ". In a separate program this would end the server, and the client would wait for ever."


def answer_for_broken_ones(patches: Patches, crashed: Callable[[BaseException, Turn], None]) -> None:
    """Have `crashed` told of what raises, and the client answered."""
    _guard(patches, "register_goal_callback", crashed, lambda *_: (_REJECTED, lambda: GoalResponse.REJECT))
    _guard(patches, "register_cancel_callback", crashed, lambda *_: (_REFUSED, lambda: CancelResponse.REJECT))
    _guard(patches, "register_handle_accepted_callback", crashed, _abort)


def _guard(patches: Patches, method: str, crashed: Callable[[BaseException, Turn], None], instead: Instead) -> None:
    original = getattr(ActionServer, method)

    @functools.wraps(original)
    def register(server: ActionServer, callback: Callable[[Any], Any] | None) -> None:
        original(server, _guarded(server, callback, crashed, instead) if callable(callback) else callback)

    patches.set(ActionServer, method, register)


def _guarded(
    server: ActionServer,
    callback: Callable[[Any], Any],
    crashed: Callable[[BaseException, Turn], None],
    instead: Instead,
) -> Callable[[Any], Any]:
    async def guarded(given: Any) -> object:
        begun = time.monotonic()
        try:
            return await await_or_execute(callback, given)
        except (CallbackStopped, GeneratorExit):  # its node has been stopped
            raise
        except BaseException as error:  # noqa: BLE001 - whatever the learner's code raises
            follows, bring_about = instead(server, given)
            node = server._node  # noqa: SLF001 - rclpy has no other way to it
            crashed(error, Turn(None, node, begun, callback, follows + _IN_A_PROGRAM))  # before the client goes on
            return bring_about()

    return guarded


def _abort(server: ActionServer, handle: ServerGoalHandle) -> tuple[str, Callable[[], object]]:
    """End an accepted goal, if its callback has not begun to execute it before it failed."""
    if handle.status != GoalStatus.STATUS_ACCEPTED:
        return _ALREADY, lambda: None

    def execute(executed: ServerGoalHandle) -> Message:
        executed.abort()
        return server.action_type.Result()

    return _ABORTED, lambda: handle.execute(execute)
