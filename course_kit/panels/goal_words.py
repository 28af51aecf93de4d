"""What a panel says of a goal: its status, its progress, its messages, each in a few words."""

from __future__ import annotations

import math
import reprlib
from typing import Any, NamedTuple

_STATUS = {
    "ACCEPTED": "accepted; it has not begun yet",
    "EXECUTING": "running",
    "CANCELING": "about to be cancelled",
    "SUCCEEDED": "succeeded",
    "CANCELED": "cancelled",
    "ABORTED": "aborted: the server gave it up",
    "REJECTED": "rejected: the server did not take it",
    "UNKNOWN": "lost: the server went away",
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


def status(name: str) -> str:
    """A goal's status as a sentence's end: "EXECUTING" is "running (EXECUTING)"."""
    return f"{_STATUS[name]} ({name})" if name in _STATUS else name


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
