"""What a panel says of a goal: its status, its progress, its messages, each in a few words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from course_kit.ros.showing import in_words, snapshot

if TYPE_CHECKING:
    from course_kit.ros.messages import Message

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
_LONGEST = 12  # values of a list that are shown
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
    return in_words(snapshot(value, _LONGEST, last=True), _DIGITS)
