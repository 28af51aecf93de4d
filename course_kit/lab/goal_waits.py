"""Waiting for news of a goal: for the server's answer, for feedback, for the result, for the end of a cancel request.

Each wait is driven by asyncio in a notebook and by an event in a program (see `calls`).
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from rclpy.exceptions import InvalidHandle

from course_kit.lab.errors import NoAnswerError

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.ros.goal import GoalClient, GoalTracker

_CHECK = 0.2  # seconds between looks at whether the server is still there
_MISSED = 2  # such looks in a row without it


class GoalSurroundings(Protocol):
    """What a goal needs to know about the lab."""

    @property
    def node(self) -> Any:
        """The lab's own node."""

    def goal_client(self, action_type: Any, action: str) -> GoalClient:
        """The lab's client for an action."""

    def do(self, function: Callable[[], None]) -> None:
        """Have the lab's thread call a function between two callbacks; does not wait for it."""

    def call_back(self, function: Callable[[], object]) -> None:
        """Call a function of the learner's on the lab's thread; what it raises is told."""

    def why_no_result(self, action: str) -> str:
        """What is known about an action server that does not answer."""

    def before_blaming(self) -> None:
        """A server has gone: let a script that is about to end say why first."""

    def flush_output(self) -> None:
        """Show what callbacks have printed; called in the caller's thread."""

    def not_in_callback(self, what: str) -> None:
        """Raise DeadlockError if the caller is a callback on the lab's thread."""


class Awaited(NamedTuple):
    """What is waited for.

    Attributes:
        lacking: begins the sentence about an answer that has not come.
        arrived: whether it has.
        begin: called on the lab's thread first.
        outcome: what to return.
    """

    lacking: str
    arrived: Callable[[], bool]
    begin: Callable[[], None] | None = None
    outcome: Callable[[], Any] = lambda: None


class Wait:
    """A wait for news of a goal; see `calls.Exchanged`.

    Args:
        lab: the surroundings.
        pursuit: the goal.
        timeout: seconds.
        awaited: the news.
    """

    def __init__(self, lab: GoalSurroundings, pursuit: GoalTracker, timeout: float, awaited: Awaited) -> None:
        self._lab = lab
        self._pursuit = pursuit
        self._timeout = timeout
        self._awaited = awaited
        self._start = time.monotonic()
        self._missing = 0  # looks in a row that have not found the server
        self._listener: Callable[[], None] = lambda: None

    def may_send(self) -> bool:
        """Whether it can begin: always, as the goal has its server already."""
        return True

    def send(self, completed: Callable[[], None]) -> None:
        """Begin; `completed` is called on the lab's thread when the answer is there."""

        def look() -> None:
            if self._awaited.arrived():
                completed()

        def begin() -> None:
            if self._awaited.begin is not None:
                self._awaited.begin()
            look()

        self._listener = look
        self._pursuit.listeners.append(look)
        if self._awaited.begin is not None:
            self._lab.do(begin)
        else:
            look()

    def next_check(self) -> float:
        """Seconds until `check` should be called."""
        return max(0.0, min(_CHECK, self._start + self._timeout - time.monotonic()))

    def check(self) -> None:
        """Look whether an answer can still come.

        Raises:
            NoAnswerError: the time is over, or the server has gone.
        """
        if self._awaited.arrived():
            return
        if time.monotonic() - self._start >= self._timeout:
            why = self._lab.why_no_result(self._pursuit.client.action_name)
            raise NoAnswerError(f"{self._awaited.lacking} within {self._timeout:g} s. {why}")
        self._missing = 0 if is_there(self._pursuit.client) else self._missing + 1
        if self._missing == _MISSED:  # before that, what it sent at the very end may be on its way
            self._lab.before_blaming()
            self._lab.do(self._pursuit.lose)
        elif self._missing > _MISSED:
            raise NoAnswerError(gone(self._pursuit.client.action_name))

    def result(self) -> Any:
        """What was waited for."""
        return self._awaited.outcome()

    def close(self) -> None:
        """Stop waiting."""
        if self._listener in self._pursuit.listeners:
            self._pursuit.listeners.remove(self._listener)
        self._lab.flush_output()


def is_there(client: Any) -> bool:
    """Whether an action's server is on the graph."""
    try:
        return bool(client.server_is_ready())
    except InvalidHandle:  # the lab is being closed
        return False


def gone(action: str) -> str:
    """The server of an action went away while a goal was on its way."""
    return (
        f"The server of {action} went away before the goal ended: its program ended or its node was stopped. "
        "Its own output says why."
    )
