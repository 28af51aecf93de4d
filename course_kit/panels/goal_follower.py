"""What panels share that send goals and show how things stand with them."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from course_kit.panels.base import Latest, Panel
from course_kit.panels.goal_sender import GoalSender

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.panels.goal_sender import Standing
    from course_kit.ros.messages import ActionType, Message


class GoalFollower(Panel):
    """A panel for one action."""

    def __init__(self, action: str) -> None:
        super().__init__(action)
        self._action = action
        self._ended = False

    def cancel(self) -> None:
        """Ask the server to cancel the goal that is shown; returns at once."""
        self._sender.cancel()

    def _follow(self, action_type: ActionType, on_feedback: Callable[[Message], None] = lambda _: None) -> None:
        """Begin; the widget is there."""
        self._updates: Latest[Standing] = Latest(self._show)
        self._sender = GoalSender(self._action, action_type, self._updates.put, on_feedback)
        self.widget.on_msg(self._told)
        self.at_close(self._end)
        self.at_close(self._updates.close)
        self.at_close(self._sender.close)
        self._show(self._sender.standing)

    @abstractmethod
    def _show(self, standing: Standing) -> None:
        """Have the page show how things stand."""

    @abstractmethod
    def _take_wish(self, wish: dict[str, Any]) -> None:
        """The page wants something done."""

    def _told(self, widget: object, wish: dict[str, Any], buffers: object) -> None:
        del widget, buffers
        if not self._ended:
            self._take_wish(wish)

    def _end(self) -> None:
        self._ended = True
        self._show(self._sender.standing)
