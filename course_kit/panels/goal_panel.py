"""A form for goals of any action type, with a progress bar fed by the server's own feedback."""

from __future__ import annotations

import contextlib
import math
import threading
from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import anywidget
import traitlets

from course_kit import lab
from course_kit.lab.errors import FieldError
from course_kit.panels.base import LatestValue, Panel, form, of_files, still
from course_kit.panels.message_form import FormError, MessageForm, Values, fields_in_words
from course_kit.ros.messages import type_name
from course_kit.ros.showing import copy_message, describe_message

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.goals import Goal
    from course_kit.ros.messages import ActionType, Message

_STATUS = {
    "SENDING": "{} is on its way to the server ...",
    "ACCEPTED": "{} is accepted and has not begun yet",
    "EXECUTING": "{} is running",
    "CANCELING": "{} is being cancelled",
    "SUCCEEDED": "{} has succeeded",
    "CANCELED": "{} was cancelled",
    "ABORTED": "{} was given up by the server",
    "REJECTED": "{} was rejected by the server",
    "UNKNOWN": "{} is lost: its server went away",
}
_SHOWN_VALUES = 12  # values of a list that are shown
_DIGITS = 2  # of a float


class Progress(NamedTuple):
    """How far a goal is."""

    share: float | None
    text: str


def status(name: str, goal: str = "The goal") -> str:
    """A goal's status in a sentence: "The goal is running (EXECUTING)."; "SENDING" is a panel's own word."""
    sentence = _STATUS.get(name, "{}").format(goal)
    return sentence if name == "SENDING" else f"{sentence} ({name})."


def progress(goal: Message, feedback: Message, count: int) -> Progress:
    """How far a goal is, by what its feedback says."""
    if feedback is None:
        return Progress(0.0, "no feedback yet")
    share = getattr(feedback, "progress", None)
    if isinstance(share, float):
        if not math.isfinite(share):
            return Progress(None, f"the feedback's progress is {share}")
        return Progress(min(max(share, 0.0), 1.0), f"{share:.0%}")
    order, terms = getattr(goal, "order", None), getattr(feedback, "sequence", None)
    if isinstance(order, int) and order > 0 and terms is not None:
        # A sequence of order n ends with term n; it begins with term 0.
        reached = len(terms) - 1
        return Progress(min(max(reached / order, 0.0), 1.0), f"term {reached} of {order}")
    return Progress(None, f"{count} feedback message{'' if count == 1 else 's'}")


def message(value: Message) -> str:
    """A message's fields in one line: "sequence=[0, 1, 1, 2]"; of a long list the last values, which are the news."""
    return describe_message(copy_message(value, _SHOWN_VALUES, last=True), _DIGITS)


RUNNING = frozenset({"ACCEPTED", "EXECUTING", "CANCELING"})
_ANSWER = 5.0  # seconds a server is given to answer
_TONES = {"SUCCEEDED": "good", "REJECTED": "bad", "ABORTED": "bad", "CANCELED": "stopped", "UNKNOWN": "bad"}
_GOODBYE = 1.0  # seconds a cancel request is given when the panel ends


@dataclass(frozen=True)
class GoalState:
    """How things stand with the latest goal."""

    asked: Message = None
    status: str = ""
    note: str = ""
    refused: Message = None
    feedback: Message = None
    count: int = 0
    result: Message = None

    @property
    def is_running(self) -> bool:
        """Whether it can be cancelled."""
        return self.status in RUNNING

    @property
    def tone(self) -> str:
        """How it goes in a word, for a colour and a mark: "", "running", "good", "bad" or "stopped"."""
        return "running" if self.is_running else _TONES.get(self.status, "bad" if self.note else "")

    @property
    def progress(self) -> Progress:
        """How far it is."""
        if self.status == "SUCCEEDED":
            return Progress(1.0, "done")
        return progress(self.asked, self.feedback, self.count)


@dataclass
class _Attempt:
    """One goal on its way to the server and back; of two, the one with the higher number is the later one."""

    number: int
    asked: Message
    goal: Goal | None = None
    to_cancel: bool = False  # as soon as the goal is known: its feedback has come first


class GoalFollower(Panel):
    """A panel for one action; it follows the latest of its goals that the server has accepted."""

    def __init__(self, action: str) -> None:
        super().__init__(action)
        self._action = action
        self._ended = False
        self._lock = threading.RLock()
        self._attempts = 0
        self._followed: _Attempt | None = None
        self._standing = GoalState()

    def cancel(self) -> threading.Thread:
        """Ask the server to cancel the goal that is shown; returns at once."""
        return _in_background(self._cancel)

    def send_goal(self, asked: Message) -> threading.Thread:
        """Send a goal message; returns at once with the thread that does it."""
        with self._lock:
            if not self._standing.is_running:
                self._put(GoalState(asked, "SENDING"))
            else:
                self._put(replace(self._standing, note="Another goal is on its way ...", refused=None))
            self._attempts += 1
            attempt = _Attempt(self._attempts, asked)
        return _in_background(lambda: self._send(attempt))

    def say(self, note: str) -> None:
        """Have something said beside the status."""
        with self._lock:
            self._put(replace(self._standing, note=note))

    def _follow_goals(self, action_type: ActionType) -> None:
        """Begin; the widget is there."""
        self._action_type = action_type
        self._updates: LatestValue[GoalState] = LatestValue(self._show)
        self.widget.on_msg(self._handle_message)
        self.at_close(lambda: self._show(self._standing))
        self.at_close(self._updates.close)
        self.at_close(self._leave)
        self._show(self._standing)

    @abstractmethod
    def _show(self, standing: GoalState) -> None:
        """Have the page show how things stand."""

    @abstractmethod
    def _take_wish(self, wish: dict[str, Any]) -> None:
        """The page wants something done, but no cancelling."""

    def _take_feedback(self, feedback: Message) -> None:
        """Feedback of the goal that is followed has come; for a panel that does more than show the latest."""

    def _handle_message(self, widget: object, wish: dict[str, Any], buffers: object) -> None:
        del widget, buffers
        if not self._ended and wish.get("do") == "cancel":
            self.cancel()
        elif not self._ended:
            self._take_wish(wish)

    def _leave(self) -> None:
        """Stop following; cancel a goal that still runs, as nobody could do so later, or `_send` when it is known."""
        with self._lock:
            self._ended = True
            followed, running = self._followed, self._standing.is_running
        if followed is not None and followed.goal is not None and running:
            with contextlib.suppress(lab.LabError):
                followed.goal.cancel_blocking(timeout=_GOODBYE)

    def _send(self, attempt: _Attempt) -> None:
        try:
            goal = lab.send_goal_blocking(
                self._action,
                self._action_type,
                attempt.asked,
                timeout=_ANSWER,
                on_feedback=lambda feedback: self._hear_feedback(attempt, feedback),
                on_result=lambda goal: _in_background(lambda: self._hear_end(attempt, goal)),
            )
        except lab.LabError as error:
            self._go_without(attempt, "", note=str(error))
            return
        if not goal.accepted:
            self._go_without(attempt, "REJECTED", refused=attempt.asked)
            return
        with self._lock:
            attempt.goal = goal
            self._follow(attempt)  # its feedback, or its end, may have come first
        if attempt.to_cancel or self._ended:
            self._cancel()

    def _cancel(self) -> None:
        with self._lock:
            followed = self._followed
            if followed is None or not self._standing.is_running:
                return
            followed.to_cancel = followed.goal is None
        if followed.goal is None:
            return
        try:
            accepted = followed.goal.cancel_blocking(timeout=_ANSWER)
        except lab.LabError as error:
            self.say(str(error))
            return
        if not accepted and self._standing.is_running:
            self.say("The server refuses to cancel it.")

    def _follow(self, attempt: _Attempt) -> bool:
        """Make it the one that is followed, unless a later one is; False then."""
        followed = self._followed
        if followed is not attempt and (followed is None or followed.number < attempt.number):
            self._followed = attempt
            self._put(GoalState(attempt.asked, "EXECUTING"))
        return self._followed is attempt

    def _go_without(self, attempt: _Attempt, status: str, *, note: str = "", refused: Message = None) -> None:
        """Nothing has come of a goal; one that runs meanwhile is still followed."""
        with self._lock:
            if self._standing.is_running:
                self._put(replace(self._standing, note=note, refused=refused))
            else:
                self._put(GoalState(attempt.asked, status, note, refused))

    def _hear_feedback(self, attempt: _Attempt, feedback: Message) -> None:
        with self._lock:
            if self._follow(attempt):
                self._take_feedback(feedback)
                self._put(replace(self._standing, feedback=feedback, count=self._standing.count + 1))

    def _hear_end(self, attempt: _Attempt, goal: Goal) -> None:
        """A goal has ended; not on the lab's thread, where nothing may be waited for."""
        if not goal.accepted:  # the one who has sent it says so
            return
        note, result = "", None
        try:
            result = goal.result_blocking(timeout=_ANSWER)
        except lab.LabError as error:
            note = str(error)
        with self._lock:
            if self._follow(attempt):
                self._put(replace(self._standing, status=goal.status, note=note, refused=None, result=result))

    def _put(self, standing: GoalState) -> None:
        self._standing = standing
        if not self._ended:
            self._updates.put(standing)


def _in_background(work: Callable[[], None]) -> threading.Thread:
    thread = threading.Thread(target=work, name="panel-goal", daemon=True)
    thread.start()
    return thread


ENDED = "This panel has ended. Run its cell again to use it."
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
        if not isinstance(action, str) or not hasattr(action_type, "Goal"):
            raise FieldError('A panel needs a name and an action type: panels.action_panel("/fibonacci", Fibonacci).')
        super().__init__(action)
        self._type = action_type
        self._form = MessageForm(action_type.Goal)
        self._errors: dict[str, str] = {}
        self.widget = _ActionWidget(
            title={"name": action, "type": type_name(action_type)},
            entries=self._form.entries(),
            values=self._form.defaults(),
        )
        self._follow_goals(action_type)

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
        """The form with what is in its fields, and what became of the last goal."""
        view = self.widget.view
        lines = [view["status"], *(f"{name}: {value}" for name, value in view["rows"])]
        picture = form(self.widget, "Goal", "Send goal", "Cancel goal", said=lines)
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
            self._updates.put(self._standing)
            return
        self._errors = {}
        self.send_goal(goal)

    def _take_wish(self, wish: dict[str, Any]) -> None:
        self.fill(wish.get("values", {}))
        if wish.get("do") == "send":
            self.send()

    def _show(self, standing: GoalState) -> None:
        progress, errors = standing.progress, self._errors
        refusal = status("REJECTED", "Another goal") if standing.refused is not None and standing.is_running else ""
        text = status_line(standing, refusal=refusal) or "No goal yet."
        self.widget.view = {
            "share": progress.share if standing.status else 0.0,
            "progress": progress.text if standing.status else "",
            "status": ENDED if self._ended else _NOT_SENT if errors else text,
            "tone": "bad" if errors else standing.tone,
            "rows": _rows(standing),
            "running": standing.is_running,
            "errors": errors,
            "ended": self._ended,
        }


def status_line(standing: GoalState, goal: str = "The goal", refusal: str = "") -> str:
    """How things stand, in sentences; empty before the first goal."""
    text = status(standing.status, goal) if standing.status else ""
    return " ".join(filter(None, (text, refusal, standing.note)))


def _rows(standing: GoalState) -> list[list[str]]:
    rows = []
    if standing.feedback is not None:
        rows.append([f"Feedback {standing.count}", message(standing.feedback)])
    if standing.result is not None:
        rows.append(["Result", message(standing.result)])
    return rows
