"""Goal, cancel and handle-accepted callbacks of action servers: what one raises is told, and the client is answered.

In a program such an exception ends the server, and its client waits for ever. Here the server keeps running: the goal
or the cancel request is rejected, and an accepted goal that nothing has begun to execute is aborted.
"""

from __future__ import annotations

import functools
import time
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import await_or_execute

from course_kit.lab.errors import CallbackStopped
from course_kit.lab.runtime.executor import Turn

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.action.server import ServerGoalHandle

    from course_kit.lab.overrides.patches import Patches
    from course_kit.ros.messages import Message

    Instead = Callable[[ActionServer, Any], tuple[str, Callable[[], object]]]  # what follows, and what brings it about

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
