"""A form for goals of any action type, with a progress bar fed by the server's own feedback."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from course_kit.lab.errors import FieldError
from course_kit.panels import goal_sender
from course_kit.panels.base import form, of_files, still
from course_kit.panels.goal_sender import GoalFollower
from course_kit.panels.message_form import FormError, MessageForm, Values, fields_in_words
from course_kit.ros.messages import is_action_type, type_name

if TYPE_CHECKING:
    from course_kit.panels.goal_sender import Standing
    from course_kit.ros.messages import ActionType

_ENDED = "This panel has ended. Run its cell again to use it."
_NOT_SENT = "Not sent: correct the marked fields above."


class _ActionWidget(anywidget.AnyWidget):
    """The panel as the page has it."""

    _esm = of_files("dom.js", "message_form.js", "goal_panel.js")
    _css = of_files("frame.css", "panels.css", "goal_panel.css")
    title = traitlets.Dict().tag(sync=True)
    entries: traitlets.List[dict[str, object]] = traitlets.List().tag(sync=True)
    values = traitlets.Dict().tag(sync=True)
    view = traitlets.Dict().tag(sync=True)


class ActionPanel(GoalFollower):
    """A panel for one action."""

    def __init__(self, action: str, action_type: ActionType) -> None:
        if not isinstance(action, str) or not is_action_type(action_type):
            raise FieldError('A panel needs a name and an action type: panels.action_panel("/fibonacci", Fibonacci).')
        super().__init__(action)
        self._type = action_type
        self._form = MessageForm(action_type.Goal)
        self._errors: dict[str, str] = {}
        self.widget = _ActionWidget(
            title={"action": action, "type": type_name(action_type)},
            entries=self._form.entries(),
            values=self._form.defaults(),
        )
        self._follow(action_type)

    def describe(self) -> str:
        """The panel in words."""
        return (
            f"A panel that sends goals to {self._action} [{type_name(self._type)}], shows how far they are, and "
            "cancels them.\n"
            f"Goal: {fields_in_words(self._type.Goal)}.\n"
            f"Feedback: {fields_in_words(self._type.Feedback)}.\n"
            f"Result: {fields_in_words(self._type.Result)}."
        )

    def still(self) -> str:
        """The form with what is in its fields."""
        title = {"name": self._action, "type": type_name(self._type)}
        picture = form(title, "Goal", self.widget.entries, self.widget.values, "Send goal", "Cancel goal")
        return still(self.describe(), picture, "still_panels.css")

    def fill(self, values: Values) -> None:
        """Type into fields of the goal, by path, such as {"order": "7"}; the others stay."""
        self.widget.values = {**self.widget.values, **values}

    def send(self) -> None:
        """Send what the fields hold, as the button does; returns at once."""
        try:
            goal = self._form.read(self.widget.values)
        except FormError as error:
            self._errors = error.fields
            self._updates.put(self._sender.standing)
            return
        self._errors = {}
        self._sender.send(goal)

    def _take_wish(self, wish: dict[str, Any]) -> None:
        self._form.type_in(self.widget, wish)
        if wish.get("do") == "send":
            self.send()
        elif wish.get("do") == "cancel":
            self.cancel()

    def _show(self, standing: Standing) -> None:
        progress, errors = standing.progress, self._errors
        self.widget.view = {
            "share": progress.share if standing.status else 0.0,
            "progress": progress.text if standing.status else "",
            "status": _ENDED if self._ended else _NOT_SENT if errors else status_line(standing),
            "tone": "bad" if errors else standing.tone,
            "rows": _rows(standing),
            "running": standing.running,
            "errors": errors,
            "ended": self._ended,
        }


def status_line(standing: Standing) -> str:
    """How things stand, in a sentence."""
    parts = []
    if standing.status:
        parts.append(goal_sender.status(standing.status))
    if standing.refused is not None and standing.running:
        parts.append(goal_sender.status("REJECTED", "Another goal"))
    if standing.note:
        parts.append(standing.note)
    return " ".join(parts) or "No goal yet."


def _rows(standing: Standing) -> list[list[str]]:
    rows = []
    if standing.feedback is not None:
        rows.append([f"Feedback {standing.count}", goal_sender.message(standing.feedback)])
    if standing.result is not None:
        rows.append(["Result", goal_sender.message(standing.result)])
    return rows
