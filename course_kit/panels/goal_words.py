"""What a panel says of a goal: its status, its progress, its messages, each in a few words."""

from __future__ import annotations

import math
import reprlib
from typing import Any, NamedTuple

_STATUS = {
    "SENDING": "{} is on its way to the server ...",
    "ACCEPTED": "{} is accepted and has not begun yet",
    "EXECUTING": "{} is running",
    "CANCELING": "{} is being cancelled",
    "SUCCEEDED": "{} has succeeded",
    "CANCELED": "{} was cancelled",
    "ABORTED": "{} was given up by the server",
    "REJECTED": "{} was rejected by the server",
    "UNKNOWN": "{} is lost, as its server went away",
}
_DIGITS = 2  # behind the decimal point
_LONGEST = 12  # values of a list that are shown
_SHORTENED = 80  # characters of a text


class Progress(NamedTuple):
    """How far a goal is.

    Attributes:
        share: 0.0 to 1.0; None where nobody can know.
        text: the same in words.
    """

    share: float | None
    text: str


def status(name: str, goal: str = "The goal") -> str:
    """A goal's status in a sentence: "The goal is running (EXECUTING)."; "SENDING" is a panel's own word."""
    sentence = _STATUS.get(name, "{}").format(goal)
    return sentence if name == "SENDING" else f"{sentence} ({name})."


def progress(goal: Any, feedback: Any, count: int) -> Progress:
    """How far a goal is, by what its feedback says.

    Args:
        goal: the goal message.
        feedback: the latest feedback message, None when there was none.
        count: feedback messages so far.
    """
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


def message(value: Any) -> str:
    """A message's fields in one line: "sequence: 0, 1, 1, 2"."""
    return "; ".join(f"{name}: {_value(getattr(value, name))}" for name in value.get_fields_and_field_types())


def _value(value: Any) -> str:
    if hasattr(value, "get_fields_and_field_types"):
        return f"({message(value)})"
    if isinstance(value, str):
        return value if len(value) <= _SHORTENED else reprlib.repr(value)
    if isinstance(value, float):
        return f"{value:.{_DIGITS}f}"
    if isinstance(value, bool | int | bytes):
        return str(value)
    return _values(value)


def _values(values: Any) -> str:
    """A list; of a long one its last values, which are the news."""
    shown = [_value(one) for one in list(values)[-_LONGEST:]]
    if len(values) > _LONGEST:
        shown.insert(0, "...")
    return ", ".join(shown) or "none"
