"""What graders ask of an action server before they send it goals: is it there, and does the grader hear it.

An action is three services and two topics below its name ("Actions" in the ROS 2 design articles). The grader uses
these themselves, not rclpy's ActionClient: that one drops feedback which arrives after the result, and hides the rest.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.qos import QoSDurabilityPolicy, QoSProfile

from course_kit.grading.bounds import bounded
from course_kit.grading.checks import discovery, retry
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import SubmissionEndedError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rclpy.client import Client

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.grader_node import Listener

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
    interface: Any
    type: str

    @property
    def wanted(self) -> discovery.Wanted:
        """What is to be on the graph."""
        return discovery.Wanted("action", self.name, self.type)


@dataclass(frozen=True)
class ReceivedFeedback:
    """Feedback, and when it was received, in seconds of the system's clock."""

    feedback: Any
    came_s: float


class Feedback:
    """What has come as feedback about goals that are followed; of one without end the beginning and the last."""

    def __init__(self) -> None:
        self.count = 0  # about whatever goal
        self._of_goals: dict[bytes, list[ReceivedFeedback]] = {}

    def of(self, goal: bytes) -> list[ReceivedFeedback]:
        """All about a goal, oldest first, from the first question for it on."""
        return self._of_goals.setdefault(goal, [])

    def take(self, message: Any, info: Any) -> None:
        """Keep one message; `info` is rclpy's."""
        self.count += 1
        all_told = self._of_goals.get(bytes(message.goal_id.uuid))
        if all_told is not None:
            del all_told[_MOST_FEEDBACK - 1 :]
            all_told.append(ReceivedFeedback(bounded(message.feedback), info["received_timestamp"] / 1e9))


class Statuses:
    """How the statuses of goals that are followed have changed."""

    def __init__(self) -> None:
        self._of_goals: dict[bytes, list[tuple[float, int]]] = {}

    def of(self, goal: bytes) -> list[tuple[float, int]]:
        """Each change, with its time on the system's clock, from the first question for the goal on."""
        return self._of_goals.setdefault(goal, [])

    def take(self, message: Any, info: Any) -> None:
        """Keep what one message has of news; `info` is rclpy's."""
        for entry in bounded(message).status_list:
            changes = self._of_goals.get(bytes(entry.goal_info.goal_id.uuid))
            if changes is not None and len(changes) < _MOST_CHANGES and entry.status not in [one for _, one in changes]:
                changes.append((info["received_timestamp"] / 1e9, entry.status))


class ActionChannels:
    """The grader's connections with an action; made on first use, and the same as long as the grader's node."""

    def __init__(self, context: CheckContext, action: WantedAction) -> None:
        parts, self._grader_node, self._name = action.interface.Impl, context.grader_node, action.name
        self.goals = self._client(parts.SendGoalService, "send_goal")
        self.cancels = self._client(parts.CancelGoalService, "cancel_goal")
        self.results = self._client(parts.GetResultService, "get_result")  # the last: see `_wait_for_match`
        self.feedback = self._listen(Feedback, parts.FeedbackMessage, "feedback", _FEEDBACK)
        self.statuses = self._listen(Statuses, parts.GoalStatusMessage, "status", _STATUS)

    def ready(self) -> bool:
        """Whether a goal can be sent and everything about it will be heard."""
        return all(client.service_is_ready() for client in (self.goals, self.results, self.cancels)) and all(
            self._grader_node.node.count_publishers(f"{self._name}/_action/{topic}") for topic in ("feedback", "status")
        )

    def _client(self, interface: Any, part: str) -> Client:
        return self._grader_node.client(interface, f"{self._name}/_action/{part}")

    def _listen(self, make: Callable[[], Listener], interface: Any, part: str, qos: QoSProfile) -> Listener:
        return self._grader_node.hear_with(make, interface, f"{self._name}/_action/{part}", qos)


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
