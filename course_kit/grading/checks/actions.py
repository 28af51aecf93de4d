"""The grader's connections with an action server: what it sends and what it hears.

An action is three services and two topics below its name ("Actions" in the ROS 2 design articles). The grader uses
these themselves, not rclpy's ActionClient: that one drops feedback which arrives after the result, and hides the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from rclpy.qos import QoSDurabilityPolicy, QoSProfile

from course_kit.grading.checks.endpoints import Server
from course_kit.grading.model.bounds import bounded
from course_kit.ros.messages import ActionType
from course_kit.ros.topic import Inbox

if TYPE_CHECKING:
    from course_kit.grading.checks.grader_node import GraderNode, Offer
    from course_kit.ros.messages import Message

_MOST_FEEDBACK = 10_000  # messages about one goal that are kept
_MOST_CHANGES = 20  # of the status of one goal
_FEEDBACK = QoSProfile(depth=1000)
_STATUS = QoSProfile(depth=100, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(frozen=True)
class ReceivedFeedback:
    """Feedback, and when it was received, in seconds of the system's clock."""

    feedback: Message
    came_s: float


class Feedback(Inbox):
    """What has come as feedback about goals that are followed; of one without end the beginning and the last."""

    def __init__(self) -> None:
        super().__init__()
        self._of_goals: dict[bytes, list[ReceivedFeedback]] = {}

    def of(self, goal: bytes) -> list[ReceivedFeedback]:
        """All about a goal, oldest first, from the first question for it on."""
        return self._of_goals.setdefault(goal, [])

    def keep(self, message: Message, received_s: float) -> None:
        """See `Inbox`."""
        all_told = self._of_goals.get(bytes(message.goal_id.uuid))
        if all_told is not None:
            del all_told[_MOST_FEEDBACK - 1 :]
            all_told.append(ReceivedFeedback(bounded(message.feedback), received_s))


class Statuses(Inbox):
    """How the statuses of goals that are followed have changed."""

    def __init__(self) -> None:
        super().__init__()
        self._of_goals: dict[bytes, list[tuple[float, int]]] = {}

    def of(self, goal: bytes) -> list[tuple[float, int]]:
        """Each change, with its time on the system's clock, from the first question for the goal on."""
        return self._of_goals.setdefault(goal, [])

    def keep(self, message: Message, received_s: float) -> None:
        """See `Inbox`; of a message only what is news."""
        for entry in bounded(message).status_list:
            changes = self._of_goals.get(bytes(entry.goal_info.goal_id.uuid))
            if changes is not None and len(changes) < _MOST_CHANGES and entry.status not in [one for _, one in changes]:
                changes.append((received_s, entry.status))


class ActionChannels:
    """The grader's connections with an action; made on first use, and the same as long as the grader's node."""

    def __init__(self, node: GraderNode, action: WantedAction) -> None:
        parts, self._below = action.interface.Impl, f"{action.name}/_action"
        self._node = node.node
        self.goals = node.client(parts.SendGoalService, f"{self._below}/send_goal")
        self.cancels = node.client(parts.CancelGoalService, f"{self._below}/cancel_goal")
        self.results = node.client(parts.GetResultService, f"{self._below}/get_result")
        self.feedback = node.inbox_of(Feedback, parts.FeedbackMessage, f"{self._below}/feedback", _FEEDBACK)
        self.statuses = node.inbox_of(Statuses, parts.GoalStatusMessage, f"{self._below}/status", _STATUS)

    def ready(self) -> bool:
        """Whether a goal can be sent and everything about it will be heard."""
        return all(client.is_ready() for client in (self.goals, self.results, self.cancels)) and all(
            self._node.count_publishers(f"{self._below}/{topic}") for topic in ("feedback", "status")
        )


@dataclass(frozen=True)
class WantedAction(Server[ActionType]):
    """An action as the exercise names it."""

    kind: ClassVar[str] = "action"

    def ready(self, node: GraderNode) -> bool:
        """See `Server`; everything about a goal will be heard, too."""
        return ActionChannels(node, self).ready()

    def offers(self, node: GraderNode) -> list[Offer]:
        """See `Server`."""
        return node.actions()
