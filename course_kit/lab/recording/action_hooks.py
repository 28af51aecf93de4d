"""Sees goals, feedback, cancel requests and results cross, and reports them; see `hooks`.

An action client and an action server are waitables, whose services and topics rclpy does not show. So the methods
they send by and take in are wrapped, on both sides. What is sent is reported before it is sent.
"""

from __future__ import annotations

import functools
import inspect
import time
import uuid
from collections import deque
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionClient, ActionServer
from rclpy.action.server import GoalEvent, ServerGoalHandle
from unique_identifier_msgs.msg import UUID

from course_kit.ros.goal import status_name
from course_kit.ros.messages import type_name
from course_kit.ros.names import full_action_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.task import Future

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.recording.events import Kind
    from course_kit.lab.recording.hooks import CallbackSpans, MessageHooks, Where
    from course_kit.ros.messages import ActionType, Message

_WHERE = "_course_kit_where"  # on a client or server: its node, the action's full name and its type
_GOAL = "_course_kit_goal"  # on the future of a cancel request: the goal's number
_KEPT = 1000  # goals that are still known as sent or accepted


def number_of(goal_id: Message) -> int:
    """A goal's identifier as a number."""
    return int.from_bytes(bytes(goal_id.uuid), "big")


class ActionHooks:
    """Wraps the methods of rclpy's action clients and servers."""

    def __init__(self, hooks: MessageHooks, patches: Patches) -> None:
        self._hooks = hooks
        self._patches = patches
        self._sent: deque[tuple[int, int]] = deque(maxlen=_KEPT)  # the client's id() and the goal
        self._accepted: deque[int] = deque(maxlen=_KEPT)
        self._cancelled: deque[int] = deque(maxlen=_KEPT)
        self._hook_clients_sending()
        self._hook_clients_taking()
        self._hook_servers()
        self._hook_goal_requests()
        self._hook_cancel_requests()
        self._hook_goal_handles()

    def _hook_clients_sending(self) -> None:
        send_goal_async, cancel_goal_async = ActionClient.send_goal_async, ActionClient._cancel_goal_async  # noqa: SLF001

        def send_goal_seen(
            client: ActionClient,
            goal: Message,
            feedback_callback: Callable[[Message], None] | None = None,
            goal_uuid: Message = None,
        ) -> Any:
            before = time.monotonic_ns()  # the answer may be here before the sending returns
            goal_uuid = UUID(uuid=list(uuid.uuid4().bytes)) if goal_uuid is None else goal_uuid
            future = send_goal_async(client, goal, feedback_callback, goal_uuid)
            self._sent.append((id(client), number_of(goal_uuid)))
            self._emit("goal_sent", client, goal, number_of(goal_uuid), before)
            return future

        def cancel_seen(client: ActionClient, goal_handle: ServerGoalHandle) -> Future:
            before = time.monotonic_ns()
            future: Future = cancel_goal_async(client, goal_handle)
            setattr(future, _GOAL, number_of(goal_handle.goal_id))
            self._emit("cancel_sent", client, {}, number_of(goal_handle.goal_id), before)
            return future

        self._patches.set(ActionClient, "send_goal_async", send_goal_seen)
        self._patches.set(ActionClient, "_cancel_goal_async", cancel_seen)

    def _hook_clients_taking(self) -> None:
        execute = ActionClient.execute

        async def execute_seen(client: ActionClient, taken_data: dict[str, Any]) -> None:
            if "goal" in taken_data:
                sequence, response = taken_data["goal"]
                goal_id = client._goal_sequence_number_to_goal_id.get(sequence)  # noqa: SLF001
                if goal_id is not None:
                    self._emit("goal_answer_received", client, _answer(response.accepted), number_of(goal_id))
            if "cancel" in taken_data:
                sequence, response = taken_data["cancel"]
                number = getattr(client._pending_cancel_requests.get(sequence), _GOAL, None)  # noqa: SLF001
                if number is not None:
                    agreed = any(number_of(goal.goal_id) == number for goal in response.goals_canceling)
                    self._emit("cancel_answer_received", client, _answer(agreed), number)
            if "feedback" in taken_data:
                message = taken_data["feedback"]
                if (id(client), number_of(message.goal_id)) in self._sent:  # other clients' goals come here as well
                    self._emit("feedback_received", client, message.feedback, number_of(message.goal_id))
            if "result" in taken_data:
                sequence, response = taken_data["result"]
                goal_id = client._result_sequence_number_to_goal_id.get(sequence)  # noqa: SLF001
                if goal_id is not None:
                    self._emit("result_received", client, _result(response), number_of(goal_id))
            await execute(client, taken_data)

        self._patches.set(ActionClient, "execute", execute_seen)

    def _hook_servers(self) -> None:
        initialise, send_result = ActionServer.__init__, ActionServer._send_result_response  # noqa: SLF001

        def initialise_seen(
            server: ActionServer, node: Node, action_type: ActionType, action_name: str, *arguments: Any, **options: Any
        ) -> None:
            initialise(server, node, action_type, action_name, *arguments, **options)
            setattr(server, _WHERE, self._describe_action(node, action_name, action_type))

        def send_result_seen(server: ActionServer, request_header: Any, future: Future) -> None:
            for identifier, known in list(server._result_futures.items()):  # noqa: SLF001
                if known is future:
                    self._emit("result_sent", server, _result(future.result()), int.from_bytes(identifier, "big"))
            send_result(server, request_header, future)

        self._patches.set(ActionServer, "__init__", initialise_seen)
        self._patches.set(ActionServer, "_send_result_response", send_result_seen)

    def _hook_goal_requests(self) -> None:
        decide = ActionServer._execute_goal_request  # noqa: SLF001
        initialise = ServerGoalHandle.__init__

        async def decide_seen(server: ActionServer, request_header_and_message: Any) -> None:
            request = request_header_and_message[1]
            number = number_of(request.goal_id)
            self._emit("goal_received", server, request.goal, number)
            await decide(server, request_header_and_message)
            if number not in self._accepted:
                self._emit("goal_answered", server, _answer(False), number)

        def initialise_seen(
            handle: ServerGoalHandle, action_server: ActionServer, goal_info: Message, goal_request: Message
        ) -> None:
            initialise(handle, action_server, goal_info, goal_request)
            self._accepted.append(number_of(goal_info.goal_id))
            self._emit("goal_answered", action_server, _answer(True), number_of(goal_info.goal_id))

        self._patches.set(ActionServer, "_execute_goal_request", decide_seen)
        self._patches.set(ServerGoalHandle, "__init__", initialise_seen)

    def _hook_cancel_requests(self) -> None:
        decide = ActionServer._execute_cancel_request  # noqa: SLF001
        update_state = ServerGoalHandle._update_state  # noqa: SLF001

        async def decide_seen(server: ActionServer, request_header_and_message: Any) -> None:
            number = number_of(request_header_and_message[1].goal_info.goal_id)
            self._emit("cancel_received", server, {}, number)
            before = self._cancelled.count(number)
            await decide(server, request_header_and_message)
            if self._cancelled.count(number) == before:
                self._emit("cancel_answered", server, _answer(False), number)

        def update_state_seen(handle: ServerGoalHandle, event: Message) -> None:
            before = time.monotonic_ns()  # its execute callback may end the goal at once
            update_state(handle, event)
            if event == GoalEvent.CANCEL_GOAL:
                self._cancelled.append(number_of(handle.goal_id))
                self._emit(
                    "cancel_answered",
                    handle._action_server,  # noqa: SLF001
                    _answer(True),
                    number_of(handle.goal_id),
                    before,
                )

        self._patches.set(ActionServer, "_execute_cancel_request", decide_seen)
        self._patches.set(ServerGoalHandle, "_update_state", update_state_seen)

    def _hook_goal_handles(self) -> None:
        publish_feedback = ServerGoalHandle.publish_feedback

        def publish_feedback_seen(handle: ServerGoalHandle, feedback: Message) -> None:
            server = handle._action_server  # noqa: SLF001
            if isinstance(feedback, server.action_type.Feedback) and handle._goal_handle is not None:  # noqa: SLF001
                self._emit("feedback_sent", server, feedback, number_of(handle.goal_id))
            publish_feedback(handle, feedback)

        self._patches.set(ServerGoalHandle, "publish_feedback", publish_feedback_seen)

    def _emit(self, kind: Kind, entity: Any, value: object, number: int, at: int = 0) -> None:
        if not self._hooks.events.observers:
            return
        where: Where | None = vars(entity).get(_WHERE)
        if where is None and isinstance(entity, ActionClient):
            where = self._describe_action(entity._node, entity._action_name, entity._action_type)  # noqa: SLF001
            setattr(entity, _WHERE, where)
        if where is not None:  # a server that was made before there was anything to report to
            self._hooks.events.emit(kind, where, value, number, at)

    def _describe_action(self, node: Node, action_name: str, action_type: ActionType) -> Where:
        name = node.get_fully_qualified_name()
        return (self._hooks.aliases.get(name, name), full_action_name(node, action_name), type_name(action_type))


def _answer(agreed: bool) -> dict[str, bool]:
    return {"accepted": bool(agreed)}


def _result(response: Message) -> dict[str, object]:
    return {"status": status_name(response.status), "result": response.result}


def hook_execution(patches: Patches, hooks: MessageHooks) -> None:
    """Have execute callbacks of goals reported, wherever they run."""
    from rclpy.action import ActionServer

    execute_goal = ActionServer._execute_goal  # noqa: SLF001 - all of a server's goals pass here

    async def execute_goal_seen(
        server: ActionServer, execute_callback: Callable[..., Any], goal_handle: ServerGoalHandle
    ) -> None:
        where = vars(server).get(_WHERE)
        if hooks.events.observers and where is not None:  # made since there is a recorder
            execute_callback = _report_execution(execute_callback, where, hooks.spans)
        await execute_goal(server, execute_callback, goal_handle)

    patches.set(ActionServer, "_execute_goal", execute_goal_seen)


def _report_execution(callback: Callable[..., Any], where: Where, spans: CallbackSpans) -> Callable[..., Any]:
    if inspect.iscoroutinefunction(callback):

        @functools.wraps(callback)
        async def execute_in_steps(goal_handle: ServerGoalHandle) -> Any:
            return await spans.steps(callback(goal_handle), where, "goal")

        return execute_in_steps

    @functools.wraps(callback)
    def execute(goal_handle: ServerGoalHandle) -> Any:
        with spans.span(where, "goal"):
            return callback(goal_handle)

    return execute
