"""Waiting for news of a goal: for the server's answer, for feedback, for the result, for the end of a cancel request.

Each wait is driven by asyncio in a notebook and by an event in a program (see `calls`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from course_kit.lab.calls import PendingCall
from course_kit.lab.errors import NoAnswerError
from course_kit.lab.graph import WantedServer
from course_kit.ros.graph import RUNS

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.runtime.engine import Engine
    from course_kit.ros.goal import GoalTracker

_MISSED = 2  # looks in a row without the server, after which it has gone


class Awaited(NamedTuple):
    """What is waited for."""

    lacking: str
    arrived: Callable[[], bool]
    begin: Callable[[], None] | None = None
    outcome: Callable[[], Any] = lambda: None


class Wait(PendingCall):
    """A wait for news of a goal."""

    def __init__(
        self, lab: Engine, tracker: GoalTracker, timeout: float, awaited: Awaited, action_type: str = ""
    ) -> None:
        super().__init__(lab, WantedServer(RUNS, tracker.client.action_name, action_type), timeout)
        self._tracker = tracker
        self._awaited = awaited
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
        self._tracker.listeners.append(look)
        if self._awaited.begin is not None:
            self._lab.do(begin)
        else:
            look()

    def result(self) -> Any:
        """What was waited for."""
        return self._awaited.outcome()

    def close(self) -> None:
        """Stop waiting."""
        if self._listener in self._tracker.listeners:
            self._tracker.listeners.remove(self._listener)
        super().close()

    def _has_come(self) -> bool:
        return self._awaited.arrived()

    def _too_late(self) -> str:
        return f"{self._awaited.lacking} within {self._timeout:g} s. {self._lab.why_no_result(self._wanted.name)}"

    def _check_server(self) -> None:
        self._missing = 0 if self._is_there() else self._missing + 1
        if self._missing == _MISSED:  # before that, what it sent at the very end may be on its way
            self._lab.before_blaming()
            self._lab.do(self._tracker.lose)
        elif self._missing > _MISSED:
            raise NoAnswerError(gone(self._wanted.name))

    def _is_there(self) -> bool:
        return self._tracker.client.has_server()


def gone(action: str) -> str:
    """The server of an action went away while a goal was on its way."""
    return (
        f"The server of {action} went away before the goal ended: its program ended or its node was stopped. "
        "Its own output says why."
    )
