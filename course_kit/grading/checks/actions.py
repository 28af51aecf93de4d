"""The grader's connections with an action server: what it sends and what it hears.

An action is three services and two topics below its name ("Actions" in the ROS 2 design articles). The grader uses
these themselves, not rclpy's ActionClient: that one drops feedback which arrives after the result, and hides the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from rclpy.qos import QoSDurabilityPolicy, QoSProfile

from course_kit.grading.model.bounds import bound_message
from course_kit.ros.topic import Inbox

if TYPE_CHECKING:
    from course_kit.grading.checks.grader_node import GraderNode
    from course_kit.ros.messages import ActionType, Message

Kept = TypeVar("Kept")
_MOST_FEEDBACK = 10_000  # messages about one goal that are kept
_MOST_CHANGES = 20  # of the status of one goal
_ENTRIES, _IDENTIFIER, _STATUS_AT = 8, 16, 24  # bytes of a serialized status message: before, and in, an entry
_FEEDBACK = QoSProfile(depth=1000)
_STATUS = QoSProfile(depth=100, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(frozen=True)
class ReceivedFeedback:
    """Feedback, and when it was received, in seconds of the system's clock."""

    feedback: Message
    came_s: float


class _GoalInbox(Inbox, Generic[Kept]):
    """What has come about goals that are followed."""

    def __init__(self) -> None:
        super().__init__()
        self._of_goals: dict[bytes, list[Kept]] = {}

    def of_goal(self, goal: bytes) -> list[Kept]:
        """All about a goal, oldest first, from the first question for it on."""
        return self._of_goals.setdefault(goal, [])


class Feedback(_GoalInbox[ReceivedFeedback]):
    """Feedback; of one without end the beginning and the last."""

    def keep(self, message: Message, received_s: float) -> None:
        """See `Inbox`."""
        changes = self._of_goals.get(bytes(message.goal_id.uuid))
        if changes is not None:
            del changes[_MOST_FEEDBACK - 1 :]
            changes.append(ReceivedFeedback(bound_message(message.feedback), received_s))


class Statuses(_GoalInbox[tuple[float, int]]):
    """Each change of a goal's status, with its time on the system's clock."""

    def keep(self, message: bytes, received_s: float) -> None:
        """See `Inbox`; of a message only what is news: each has all recent goals, so it is read as it came."""
        place = _ENTRIES
        while place + _STATUS_AT < len(message):
            goal = message[place : place + _IDENTIFIER]
            place += (-place) % 4 + _STATUS_AT
            changes, status = self._of_goals.get(goal), message[place]
            if changes is not None and len(changes) < _MOST_CHANGES and status not in [known for _, known in changes]:
                changes.append((received_s, status))
            place += 1


class ActionChannels:
    """The grader's connections with an action; made on first use, and the same as long as the grader's node."""

    def __init__(self, node: GraderNode, name: str, interface: ActionType) -> None:
        parts, self._below = interface.Impl, f"{name}/_action"
        self._node = node.node
        self.goals = node.client(parts.SendGoalService, f"{self._below}/send_goal")
        self.cancels = node.client(parts.CancelGoalService, f"{self._below}/cancel_goal")
        self.results = node.client(parts.GetResultService, f"{self._below}/get_result")
        self.feedback = node.inbox_of(Feedback, parts.FeedbackMessage, f"{self._below}/feedback", _FEEDBACK)
        self.statuses = node.inbox_of(Statuses, parts.GoalStatusMessage, f"{self._below}/status", _STATUS, raw=True)

    def is_ready(self) -> bool:
        """Whether a goal can be sent and everything about it will be heard."""
        return all(client.is_ready() for client in (self.goals, self.results, self.cancels)) and all(
            self._node.count_publishers(f"{self._below}/{topic}") for topic in ("feedback", "status")
        )
