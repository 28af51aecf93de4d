"""What graders ask of an action server before they send it goals: is it there, and does the grader hear it.

An action is three services and two topics below its name ("Actions" in the ROS 2 design articles). The grader uses
these themselves, not rclpy's ActionClient: that one drops feedback which arrives after the result, and hides the rest.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rclpy.qos import QoSDurabilityPolicy, QoSProfile

from course_kit.grading.bounds import bounded
from course_kit.grading.checks import discovery, retry
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import SubmissionEndedError
from course_kit.ros.topic import Inbox

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import ActionType, Message

_MOST_FEEDBACK = 10_000  # messages about one goal that are kept
_MOST_CHANGES = 20  # of the status of one goal
_FEEDBACK = QoSProfile(depth=1000)
_STATUS = QoSProfile(depth=100, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(frozen=True)
class WantedAction:
    """An action as the exercise names it.

    Attributes:
        name: its full name.
        interface: its class.
        type: the interface's name, `package/action/Name`.
    """

    name: str
    interface: ActionType
    type: str

    @property
    def wanted(self) -> discovery.Wanted:
        """What is to be on the graph."""
        return discovery.Wanted("action", self.name, self.type)


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

    def __init__(self, context: CheckContext, action: WantedAction) -> None:
        node, parts, self._below = context.grader_node, action.interface.Impl, f"{action.name}/_action"
        self._node = node.node
        self.goals = node.client(parts.SendGoalService, f"{self._below}/send_goal")
        self.cancels = node.client(parts.CancelGoalService, f"{self._below}/cancel_goal")
        self.results = node.client(parts.GetResultService, f"{self._below}/get_result")  # the last: `_wait_for_match`
        self.feedback = node.inbox_of(Feedback, parts.FeedbackMessage, f"{self._below}/feedback", _FEEDBACK)
        self.statuses = node.inbox_of(Statuses, parts.GoalStatusMessage, f"{self._below}/status", _STATUS)

    def ready(self) -> bool:
        """Whether a goal can be sent and everything about it will be heard."""
        return all(client.is_ready() for client in (self.goals, self.results, self.cancels)) and all(
            self._node.count_publishers(f"{self._below}/{topic}") for topic in ("feedback", "status")
        )


def expect_action(context: CheckContext, action: WantedAction) -> Evidence:
    """The action is on the graph, with its type, and its program is there to be sent goals.

    Raises:
        Failed: it is not; with start.*, name.action, type.interface or limit.*.
    """
    expected = f"the action {action.name} of type {action.type}"
    line = ActionChannels(context, action)
    discovery.await_offer(context, action.wanted, line.ready, context.grader_node.actions)
    try:
        _wait_for_match(context, action)
    except SubmissionEndedError as ended:
        if ended.diagnosis == "start.exit":
            evidence = Evidence("", expected, "a program that has ended")
            raise Failed(evidence, ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def ensure_ready(context: CheckContext, action: WantedAction) -> None:
    """Have a running submission that offers the action: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up a second time.
    """
    if context.spoiled:
        start_again(context, action)


def start_again(context: CheckContext, action: WantedAction, variables: Mapping[str, str] | None = None) -> None:
    """Start the submission anew, with other environment variables if wanted.

    Args:
        context: the check's.
        action: what it is to offer.
        variables: environment variables that differ from the exercise's own.

    Raises:
        Failed: it does not come up a second time.
    """
    discovery.start_again(context, action.wanted, lambda: ActionChannels(context, action).ready(), variables)
    with suppress(SubmissionEndedError):  # whoever needs it will notice
        _wait_for_match(context, action)


def _wait_for_match(context: CheckContext, action: WantedAction) -> None:
    """Ask for the result of a goal that does not exist; whether that is answered does not matter."""
    retry.wait_for_match(
        context, ActionChannels(context, action).results, action.interface.Impl.GetResultService.Request()
    )
