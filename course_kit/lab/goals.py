"""Sending a goal and following it: `goal = await lab.send_goal("/fibonacci", Fibonacci, order=5)`.

A `Goal` is what the learner holds; what arrives for it is kept by its `GoalTracker`, on the lab's thread.
"""

from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING, Any, NamedTuple

from course_kit.lab import calls, graph
from course_kit.lab.errors import ActionNotFoundError, FieldError, LabError, NoAnswerError
from course_kit.lab.goal_waits import Awaited, Wait, gone, is_there
from course_kit.lab.messages import build
from course_kit.lab.recording.snapshot import snapshot
from course_kit.ros.goal import GoalTracker
from course_kit.ros.graph import RUNS
from course_kit.ros.messages import is_action_type, type_name

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from course_kit.lab.goal_waits import GoalSurroundings

_QUIET = 60.0  # seconds without any news of a goal, until its feedback is no longer waited for


class AskedGoal(NamedTuple):
    """What a caller wants.

    Attributes:
        goal: a ready goal message, or None to build one of `fields`.
        fields: the goal's fields.
        timeout: seconds until the server must have accepted or rejected it.
        on_feedback: called with each feedback message, on the lab's thread.
        on_result: called with the goal when it has ended, on the lab's thread.
    """

    goal: Any
    fields: dict[str, Any]
    timeout: float
    on_feedback: Callable[[Any], object] | None = None
    on_result: Callable[[Goal], object] | None = None


class Goal:
    """A goal that a server has accepted or rejected.

    Attributes:
        action: the action's full name.
        request: the goal message.
    """

    def __init__(self, lab: GoalSurroundings, pursuit: GoalTracker, request: Any) -> None:
        self.action = pursuit.client.action_name
        self.request = request
        self._lab = lab
        self._pursuit = pursuit

    @property
    def accepted(self) -> bool:
        """Whether the server has accepted it."""
        return bool(self._pursuit.accepted)

    @property
    def status(self) -> str:
        """Its state, as ROS 2 calls it.

        Returns:
            "REJECTED", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED" or "ABORTED"; "UNKNOWN" if its
            server has gone before it ended.
        """
        return self._pursuit.status

    @property
    def done(self) -> bool:
        """Whether it has ended, or was rejected."""
        return self._pursuit.ended

    @property
    def feedback(self) -> list[Any]:
        """The feedback messages received so far."""
        return list(self._pursuit.feedback)

    async def result(self, timeout: float = 60.0) -> Any:
        """Wait for the result message; `status` says whether it was reached.

        Raises:
            LabError: the goal was rejected, so there is none.
            NoAnswerError: it has not ended within `timeout` seconds, or its server went away.
        """
        return self._result_of(await calls.call_async(self._wait_for_end(timeout)))

    def result_blocking(self, timeout: float = 60.0) -> Any:
        """The same as `result` for programs, which have no `await` at top level."""
        return self._result_of(calls.call_blocking(self._wait_for_end(timeout), self._lab.flush_output))

    async def cancel(self, timeout: float = 5.0) -> bool:
        """Ask the server to cancel it.

        Returns:
            whether the server has agreed; the goal ends when its execute callback sees the request. A goal that has
            ended cannot be cancelled.

        Raises:
            NoAnswerError: no answer within `timeout` seconds, or the server went away.
        """
        return bool(await calls.call_async(self._wait_for_cancel(timeout)))

    def cancel_blocking(self, timeout: float = 5.0) -> bool:
        """The same as `cancel` for programs."""
        return bool(calls.call_blocking(self._wait_for_cancel(timeout), self._lab.flush_output))

    async def __aiter__(self) -> AsyncIterator[Any]:
        """Each feedback message from the first one on, until the goal has ended.

        Raises:
            NoAnswerError: the server went away, or nothing was heard of the goal for 60 s.
        """
        pursuit = self._pursuit
        for number in itertools.count():
            if len(pursuit.feedback) <= number and not pursuit.ended:
                self._lab.not_in_callback("async for feedback in goal")
                await calls.call_async(self._wait_for_news(number))
            if len(pursuit.feedback) <= number:
                break
            yield pursuit.feedback[number]
        if pursuit.status == "UNKNOWN":
            raise NoAnswerError(gone(self.action))

    def __repr__(self) -> str:
        fields = snapshot(self.request)
        shown = ", ".join(f"{name}={value!r}" for name, value in fields.items()) if isinstance(fields, dict) else ""
        # Whether it is executing already is a matter of microseconds; a stored notebook shows the same each time.
        state = "accepted" if self.status in {"ACCEPTED", "EXECUTING"} else self.status
        return f"Goal({shown}) for {self.action}: {state}"

    def _wait_for_end(self, timeout: float) -> Wait:
        pursuit = self._pursuit
        if pursuit.accepted is False:
            raise LabError(f"{self.action} has rejected this goal, so there will be no result.")
        self._lab.not_in_callback("result() of a goal")
        awaited = Awaited(f"{self.action} did not finish the goal", lambda: pursuit.ended)
        return Wait(self._lab, pursuit, timeout, awaited)

    def _wait_for_news(self, number: int) -> Wait:
        pursuit = self._pursuit
        awaited = Awaited(
            f"No feedback and no result of the goal for {self.action} arrived",
            lambda: len(pursuit.feedback) > number or pursuit.ended,
        )
        return Wait(self._lab, pursuit, _QUIET, awaited)

    def _result_of(self, _: object) -> Any:
        if self._pursuit.result is None:
            self._lab.before_blaming()
            raise NoAnswerError(gone(self.action))
        return self._pursuit.result

    def _wait_for_cancel(self, timeout: float) -> Wait:
        self._lab.not_in_callback("cancel() of a goal")
        answer: list[bool] = []
        awaited = Awaited(
            f"{self.action} did not answer the request to cancel",
            lambda: bool(answer),
            lambda: self._pursuit.cancel(answer.append),
            lambda: answer[0],
        )
        return Wait(self._lab, self._pursuit, timeout, awaited)


class Sending(Wait):
    """The wait until a server has accepted or rejected a goal.

    Raises:
        FieldError: the goal cannot be built.
    """

    def __init__(self, lab: GoalSurroundings, action: str, action_type: Any, asked: AskedGoal) -> None:
        request = _goal_message(action_type, asked)
        client = lab.goal_client(action_type, action)
        pursuit = GoalTracker(client, request, lab.call_back)
        goal = Goal(lab, pursuit, request)
        pursuit.on_feedback = asked.on_feedback
        on_result = asked.on_result
        if on_result is not None:
            pursuit.on_result = lambda: on_result(goal)
        self._type = type_name(action_type)
        awaited = Awaited(
            f"{client.action_name} neither accepted nor rejected the goal",
            lambda: pursuit.accepted is not None,
            pursuit.begin,
            lambda: goal,
        )
        super().__init__(lab, pursuit, asked.timeout, awaited)

    def may_send(self) -> bool:
        """Whether the server is there.

        Raises:
            ActionNotFoundError: it has been waited for long enough.
        """
        if is_there(self._pursuit.client):
            return True
        waited = min(calls.APPEARANCE, self._timeout)
        if time.monotonic() - self._start < waited:
            return False
        action = self._pursuit.client.action_name
        raise ActionNotFoundError(
            graph.not_offered(self._lab.node, graph.WantedServer(RUNS, action, self._type), waited)
        )

    def close(self) -> None:
        """Stop waiting; a goal that nobody will hold is cancelled should it be accepted after all."""
        if self._pursuit.accepted is None:
            self._pursuit.unwanted = True
        super().close()


def _goal_message(action_type: Any, asked: AskedGoal) -> Any:
    if not is_action_type(action_type):
        raise FieldError(_not_an_action(action_type))
    if asked.goal is None:
        return build(action_type.Goal, asked.fields, f"a goal of {type_name(action_type)}")
    if asked.fields or not isinstance(asked.goal, action_type.Goal):
        raise FieldError(f"Pass either a goal of {type_name(action_type)} or its fields as keywords.")
    return asked.goal


def _not_an_action(given: Any) -> str:
    hint = ""
    owner = getattr(given, "__name__", "")
    if owner.endswith(("_Goal", "_Result", "_Feedback")):
        hint = f" Use {owner.rpartition('_')[0]} itself."
    elif not isinstance(given, type):
        hint = " The order is: lab.send_goal(name, Type, field=value)."
    return f"{owner or repr(given)} is not an action type.{hint}"
