"""The kit's own action client: rclpy's, whose feedback is not lost, and a goal on its way.

rclpy's forgets a goal's feedback callback when the result arrives. Here all that has arrived is taken at once, and
handed on before the result. Everything runs on the thread that spins the node, the sending too (issue 1123 of rclpy).
"""

from __future__ import annotations

import uuid
import weakref
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import InvalidHandle
from rclpy.qos import QoSProfile
from unique_identifier_msgs.msg import UUID

from course_kit.ros.names import full_action_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.action.client import ClientGoalHandle
    from rclpy.node import Node
    from rclpy.task import Future

    from course_kit.ros.messages import ActionType, Message

_LOOK = 0.5  # seconds between looks at whether the servers of goals are still there
_DEPTH = 1000  # feedback messages that may wait while a callback keeps the thread
# By action_msgs/msg/GoalStatus.
_STATUS = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
# Of a goal that has not ended; a status message may be older than what is known already.
_ORDER = ("", "ACCEPTED", "EXECUTING", "CANCELING")


def status_name(status: int) -> str:
    """A status of action_msgs/msg/GoalStatus in words; a number that has none as it is."""
    return _STATUS[status] if 0 <= status < len(_STATUS) else str(status)


class GoalClient(ActionClient):
    """An action client that keeps track of its goals."""

    def __init__(self, node: Node, action_type: ActionType, action: str) -> None:
        super().__init__(
            node,
            action_type,
            action,
            callback_group=ReentrantCallbackGroup(),
            feedback_sub_qos_profile=QoSProfile(depth=_DEPTH),
        )
        self.action_name = full_action_name(node, action)
        self._own_node = node
        self._feedback_message = action_type.Impl.FeedbackMessage
        self.busy: list[GoalTracker] = []  # of goals that have not ended
        self._trackers: weakref.WeakValueDictionary[bytes, GoalTracker] = weakref.WeakValueDictionary()
        self._watch = node.create_timer(
            _LOOK, self._look_for_servers, callback_group=self.callback_group, autostart=False
        )

    def add_future(self, future: Future) -> None:
        """Leave a future without an executor, so that it calls back at once, in the order in which things arrive."""

    def remove_future(self, future: Future) -> None:
        """See `add_future`."""

    def take_data(self) -> dict[str, Any]:
        """Take what has arrived, all of the feedback included."""
        data: dict[str, Any] = super().take_data()
        first = data.pop("feedback", None)
        data["all_feedback"] = [] if first is None else [first]
        handle = getattr(self, "_client_handle", None)  # a private name; see ros.compat
        while handle is not None and (more := handle.take_feedback(self._feedback_message)) is not None:
            data["all_feedback"].append(more)
        return data

    async def execute(self, taken_data: dict[str, Any]) -> None:
        """Hand on what was taken, feedback before a result."""
        if "goal" in taken_data:
            await super().execute({"goal": taken_data.pop("goal")})
        for message in taken_data.pop("all_feedback"):
            await super().execute({"feedback": message})  # for whoever records; it has no callback of rclpy's
            if tracker := self._trackers.get(bytes(message.goal_id.uuid)):  # else a goal of another client
                tracker.take_feedback(message.feedback)
        for status in getattr(taken_data.get("status"), "status_list", ()):
            if tracker := self._trackers.get(bytes(status.goal_info.goal_id.uuid)):
                tracker.note_status(status_name(status.status))
        await super().execute(taken_data)

    def begin(self, tracker: GoalTracker, goal: Message) -> Future:
        """Send a goal; returns the future of rclpy's goal handle."""
        identifier = UUID(uuid=list(uuid.uuid4().bytes))
        tracker.identifier = bytes(identifier.uuid)
        self._trackers[tracker.identifier] = tracker
        self.busy.append(tracker)
        self._watch.reset()
        sent: Future = self.send_goal_async(goal, goal_uuid=identifier)
        return sent

    def has_server(self) -> bool:
        """Whether a server is connected; never when the node has been destroyed."""
        try:
            return bool(self.server_is_ready())
        except InvalidHandle:
            return False

    def servers(self) -> frozenset[bytes]:
        """What identifies the action's servers that are on the graph; one that was started again is another."""
        found = self._own_node.get_publishers_info_by_topic(f"{self.action_name}/_action/feedback")
        return frozenset(bytes(end.endpoint_gid) for end in found)

    def destroy(self) -> None:
        """Destroy it, and the timer that belongs to it; goals that have not ended are lost."""
        for tracker in list(self.busy):
            tracker.lose()
        self._own_node.destroy_timer(self._watch)
        super().destroy()

    def _look_for_servers(self) -> None:
        """Tell of goals whose server has gone: of itself no result would ever come."""
        servers = self.servers()
        for tracker in list(self.busy):
            tracker.note_servers(servers)
        if not self.busy:
            self._watch.cancel()


class GoalTracker:
    """A goal on its way: what is known of it. Changed on the thread that spins the node, read anywhere."""

    def __init__(
        self, client: GoalClient, goal: Message, call: Callable[[Callable[[], object]], object] = lambda run: run()
    ) -> None:
        self.client = client
        self.identifier = b""
        self.accepted: bool | None = None
        self.status = ""
        self.feedback: list[Message] = []
        self.ended = False
        self.result: Message = None
        self.on_feedback: Callable[[Message], object] | None = None
        self.on_result: Callable[[], object] | None = None
        self.listeners: list[Callable[[], None]] = []
        self.unwanted = False
        self._goal = goal
        self._servers: frozenset[bytes] = frozenset()
        self._missed = 0
        self._call = call
        self._handle: ClientGoalHandle | None = None

    def begin(self) -> None:
        """Send it."""
        if not self.unwanted:
            self.client.begin(self, self._goal).add_done_callback(self._take_answer)

    def cancel(self, answered: Callable[[bool], None]) -> None:
        """Ask the server to cancel it; `answered` gets whether it will."""
        handle = self._handle
        if self.ended or handle is None:
            answered(False)
            self._notify_listeners()
            return

        def take_cancel_answer(future: Future) -> None:
            agreed = any(info.goal_id == handle.goal_id for info in future.result().goals_canceling)
            if agreed:
                self.note_status("CANCELING")
            answered(agreed)
            self._notify_listeners()

        handle.cancel_goal_async().add_done_callback(take_cancel_answer)

    def note_status(self, status: str) -> None:
        """The server has published a state; the result tells the final one."""
        if not self.ended and status in _ORDER and _ORDER.index(status) > _ORDER.index(self.status):
            self.status = status
            self._notify_listeners()

    def take_feedback(self, message: Message) -> None:
        """A feedback message has come."""
        self.feedback.append(message)
        self.note_status("EXECUTING")  # a goal with feedback is; the message that says so may come later
        on_feedback = self.on_feedback
        if on_feedback is not None:
            self._call(lambda: on_feedback(message))
        self._notify_listeners()

    def note_servers(self, servers: frozenset[bytes]) -> None:
        """Which servers of its action are there now; without its own it is lost, at the second look."""
        there = servers & self._servers if self.accepted else servers
        self._missed = 0 if there else self._missed + 1
        if self._missed > 1:
            self.lose()

    def lose(self) -> None:
        """Its server has gone: there will be no result."""
        self._end("UNKNOWN", None)

    def _take_answer(self, future: Future) -> None:
        handle = self._handle = future.result()
        if not handle.accepted:
            self.accepted = False
            self._end("REJECTED", None)
            return
        self.accepted = True
        self._servers = self.client.servers()
        self.status = self.status or "ACCEPTED"
        handle.get_result_async().add_done_callback(self._take_result)
        if self.unwanted:
            handle.cancel_goal_async()
        self._notify_listeners()

    def _take_result(self, future: Future) -> None:
        response = future.result()
        self._end(status_name(response.status), response.result)

    def _end(self, status: str, result: Message) -> None:
        if self.ended:
            return
        self.status, self.result, self.ended = status, result, True
        self.client.busy.remove(self)
        if self.on_result is not None and self.accepted is not None:
            self._call(self.on_result)
        self._notify_listeners()

    def _notify_listeners(self) -> None:
        for listener in tuple(self.listeners):
            listener()
