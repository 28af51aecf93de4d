"""One line of a sequence diagram."""

from __future__ import annotations

from typing import Literal, NamedTuple

Style = Literal[
    "request",
    "response",
    "message",
    "failure",
    "goal",
    "goal response",
    "feedback",
    "cancel request",
    "cancel response",
    "result",
]
UNSEEN = "another program"  # takes part, and nobody has told us its name
NOBODY = "nobody"


class Arrow(NamedTuple):
    """One line of a sequence diagram.

    Attributes:
        sender: a node's name.
        receiver: a node's name.
        channel: the service, topic or action.
        style: what it is.
        text: the values, or what went wrong.
    """

    sender: str
    receiver: str
    channel: str
    style: Style
    text: str


Timed = tuple[tuple[int, int], Arrow]  # when it crossed, in nanoseconds, and its place among those of that moment
