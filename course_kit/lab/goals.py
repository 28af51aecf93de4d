"""Sending a goal and following it: `goal = await lab.send_goal("/fibonacci", Fibonacci, order=5)`.

A `Goal` is what the learner holds; what arrives for it is kept by its `GoalTracker`, on the lab's thread.
"""

from __future__ import annotations

import itertools
from functools import partial
from typing import TYPE_CHECKING, Any

from course_kit.lab.awaiting import to_be_awaited
from course_kit.lab.calls import PendingCall, call_async, call_blocking, make_part, server_gone
from course_kit.lab.clients import WantedServer
from course_kit.lab.errors import LabError, NoAnswerError
from course_kit.lab.runtime.describe import actions_of
from course_kit.ros.goal import GoalTracker
from course_kit.ros.graph import RUNS
from course_kit.ros.messages import type_name
from course_kit.ros.showing import copy_message

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from course_kit.lab.runtime.engine import Engine
    from course_kit.ros.filling import Fields
    from course_kit.ros.messages import ActionType, Message


class Wait(PendingCall):
    """A wait for news of a goal: until they have `arrived`, else something is `lacking`."""

    def __init__(  # noqa: PLR0913, PLR0917 - what is waited for, how it begins, and what comes of it
        self,
        lab: Engine,
        tracker: GoalTracker,
        timeout: float,
        lacking: str,
        arrived: Callable[[], bool],
        begin: Callable[[], object] | None = None,
        outcome: Callable[[], Any] = lambda: None,
        action_type: str = "",
    ) -> None:
        super().__init__(lab, WantedServer(RUNS, tracker.client.action_name, action_type), timeout)
        self._tracker = tracker
        self._lacking, self._arrived, self._begin, self._outcome = lacking, arrived, begin, outcome
        self._listener: Callable[[], None] = lambda: None

    def may_send(self) -> bool:
        """Whether it can begin: always, as the goal has its server already."""
        return True

    def send(self, completed: Callable[..., None]) -> None:
        """Begin; `completed` is called on the lab's thread when there are news."""
        self._listener = completed
        self._tracker.listeners.append(completed)
        if self._begin is not None:
            self._lab.executor.create_task(self._begin)

    def result(self) -> Any:
        """What was waited for."""
        return self._outcome()

    def close(self) -> None:
        """Stop waiting."""
        if self._listener in self._tracker.listeners:
            self._tracker.listeners.remove(self._listener)
        super().close()

    def has_come(self) -> bool:
        """Whether they have arrived."""
        return self._arrived()

    def _too_late(self) -> str:
        return f"{self._lacking} within {self._timeout:g} s. {self._lab.why_no_result(self._wanted.name)}"

    def _is_gone(self) -> bool:
        return self._tracker.status == "UNKNOWN"

    def _is_there(self) -> bool:
        return self._tracker.client.has_server()

    def _is_ours(self) -> bool:
        return any(self._wanted.name in actions_of(node) for live in self._lab.nodes.live for node in live.made)


_QUIET = 60.0  # seconds without any news of a goal, until its feedback is no longer waited for


class Goal:
    """A goal that a server has accepted or rejected.

    Attributes:
        action: the action's full name.
        request: the goal message.
    """

    def __init__(self, lab: Engine, tracker: GoalTracker, request: Message) -> None:
        self.action = tracker.client.action_name
        self.request = request
        self._lab = lab
        self._tracker = tracker

    @property
    def accepted(self) -> bool:
        """Whether the server has accepted it."""
        return bool(self._tracker.accepted)

    @property
    def status(self) -> str:
        """Its state, as ROS 2 calls it.

        Returns:
            "REJECTED", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED" or "ABORTED"; "UNKNOWN" if its
            server has gone before it ended.
        """
        return self._tracker.status

    @property
    def done(self) -> bool:
        """Whether it has ended, or was rejected."""
        return self._tracker.ended

    @property
    def feedback(self) -> list[Message]:
        """The feedback messages received so far."""
        return list(self._tracker.feedback)

    @to_be_awaited("goal.result", "The result was not waited for")
    async def result(self, timeout: float = 60.0) -> Message:
        """Wait for the result message; `status` says whether it was reached.

        Raises:
            LabError: the goal was rejected, so it has no result.
            NoAnswerError: it has not ended within `timeout` seconds, or its server went away.
        """
        return self._result_of(await call_async(self._wait_for_end(timeout)))

    def result_blocking(self, timeout: float = 60.0) -> Message:
        """The same as `result` for programs, which have no `await` at top level."""
        return self._result_of(call_blocking(self._wait_for_end(timeout)))

    @to_be_awaited("goal.cancel")
    async def cancel(self, timeout: float = 5.0) -> bool:
        """Ask the server to cancel it.

        Returns:
            whether the server has agreed; the goal ends when its execute callback sees the request. A goal that has
            ended cannot be cancelled.

        Raises:
            NoAnswerError: no answer within `timeout` seconds, or the server went away.
        """
        return bool(await call_async(self._wait_for_cancel(timeout)))

    def cancel_blocking(self, timeout: float = 5.0) -> bool:
        """The same as `cancel` for programs."""
        return bool(call_blocking(self._wait_for_cancel(timeout)))

    async def __aiter__(self) -> AsyncIterator[Message]:
        """Each feedback message from the first one on, until the goal has ended.

        Raises:
            NoAnswerError: the server went away, or nothing was heard of the goal for 60 s.
        """
        tracker = self._tracker
        for number in itertools.count():
            if len(tracker.feedback) <= number and not tracker.ended:
                self._lab.not_in_callback("async for feedback in goal")
                await call_async(self._wait_for_news(number))
            if len(tracker.feedback) <= number:
                break
            yield tracker.feedback[number]
        if tracker.status == "UNKNOWN":
            raise NoAnswerError(server_gone(self._lab, RUNS, self.action))

    def __repr__(self) -> str:
        fields = copy_message(self.request)
        text = ", ".join(f"{name}={value!r}" for name, value in fields.items()) if isinstance(fields, dict) else ""
        # Whether it is executing already is a matter of microseconds; a stored notebook shows the same each time.
        state = "accepted" if self.status in {"ACCEPTED", "EXECUTING"} else self.status
        return f"Goal({text}) for {self.action}: {state}"

    def _wait_for_end(self, timeout: float) -> Wait:
        tracker = self._tracker
        if tracker.accepted is False:
            raise LabError(f"{self.action} has rejected this goal, so there will be no result.")
        self._lab.not_in_callback("result() of a goal")
        return Wait(self._lab, tracker, timeout, f"{self.action} did not finish the goal", lambda: tracker.ended)

    def _wait_for_news(self, number: int) -> Wait:
        tracker = self._tracker
        lacking = f"No feedback and no result of the goal for {self.action} arrived"
        return Wait(self._lab, tracker, _QUIET, lacking, lambda: len(tracker.feedback) > number or tracker.ended)

    def _result_of(self, _: object) -> Message:
        if self._tracker.result is None:
            raise NoAnswerError(server_gone(self._lab, RUNS, self.action))
        return self._tracker.result

    def _wait_for_cancel(self, timeout: float) -> Wait:
        self._lab.not_in_callback("cancel() of a goal")
        answer: list[bool] = []
        lacking = f"{self.action} did not answer the request to cancel"
        ask = partial(self._tracker.cancel, answer.append)
        return Wait(self._lab, self._tracker, timeout, lacking, lambda: bool(answer), ask, lambda: answer[0])


class PendingGoal(Wait):
    """The wait until a server has accepted or rejected a goal."""

    def __init__(  # noqa: PLR0913, PLR0917 - a goal, and where it goes
        self, lab: Engine, action: str, action_type: ActionType, ready: Message, fields: Fields, timeout: float
    ) -> None:
        request = make_part(action_type, "Goal", ready, fields)
        client = lab.clients.goal_client(action_type, action)
        tracker = GoalTracker(client, request, lab.call_back)
        self.goal = goal = Goal(lab, tracker, request)
        super().__init__(
            lab,
            tracker,
            timeout,
            f"{client.action_name} neither accepted nor rejected the goal",
            lambda: tracker.accepted is not None,
            tracker.begin,
            lambda: goal,
            type_name(action_type),
        )

    def call_back(
        self, on_feedback: Callable[[Message], object] | None, on_result: Callable[[Goal], object] | None
    ) -> PendingGoal:
        """Have functions called with each feedback message, and with the goal when it has ended."""
        self._tracker.on_feedback = on_feedback
        if on_result is not None:
            self._tracker.on_result = lambda: on_result(self.goal)
        return self

    def may_send(self) -> bool:
        """Whether the server is there; see `PendingCall.may_send`."""
        return PendingCall.may_send(self)

    def close(self) -> None:
        """Stop waiting; a goal that nobody will hold is cancelled should it be accepted after all."""
        if self._tracker.accepted is None:
            self._tracker.unwanted = True
        super().close()
