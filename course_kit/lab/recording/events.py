"""What the lab reports about messages that cross between nodes, and to whom.

Nothing here imports rclpy: recorders and the processes of scripts share it.
"""

from __future__ import annotations

import time
from collections import deque
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, get_args

from course_kit.ros.showing import copy_message

if TYPE_CHECKING:
    from collections.abc import Callable

Kind = Literal[
    "request_sent",
    "request_received",
    "response_sent",
    "response_received",
    "callback_failed",
    "published",
    "received",
    "goal_sent",
    "goal_received",
    "goal_answered",
    "goal_answer_received",
    "feedback_sent",
    "feedback_received",
    "cancel_sent",
    "cancel_received",
    "cancel_answered",
    "cancel_answer_received",
    "result_sent",
    "result_received",
    "callback_begun",
    "callback_ended",
]
KINDS: frozenset[str] = frozenset(get_args(Kind))
SPAN_KINDS = frozenset({"callback_begun", "callback_ended"})
KEPT = 2000  # events; a call has four


class Event(NamedTuple):
    """One thing seen at the boundary between a node and the middleware."""

    kind: Kind
    node: str
    channel: str
    type_name: str
    value: Any
    sequence: int
    at: int


class EventStream:
    """Where events are reported; costs one comparison while nobody listens."""

    def __init__(self) -> None:
        self.observers: tuple[Callable[[Event], None], ...] = ()

    def listen(self, observer: Callable[[Event], None]) -> None:
        """Have every further event passed to `observer`; once, however often this is called."""
        if observer not in self.observers:
            self.observers = (*self.observers, observer)

    def ignore(self, observer: Callable[[Event], None]) -> None:
        """Pass no further event to `observer`; nothing happens if it does not listen."""
        self.observers = tuple(other for other in self.observers if other != observer)

    def emit(self, kind: Kind, where: tuple[str, str, str], message: object, sequence: int = 0, at: int = 0) -> None:
        """Report something that happened now, or at `at`; `where` is node, channel and type name."""
        if self.observers:
            self.forward(Event(kind, *where, copy_message(message), sequence, at or time.monotonic_ns()))

    def forward(self, event: Event) -> None:
        """Report an event unchanged, such as one that comes from another process."""
        for observer in self.observers:
            observer(event)


class Recording:
    """What has crossed since it began, up to a number of events."""

    def __init__(self) -> None:
        self._events: deque[Event] = deque(maxlen=KEPT)
        self._spans: deque[Event] = deque(maxlen=KEPT)  # apart, so that a fast timer pushes no call out

    @property
    def events(self) -> list[Event]:
        """The events, oldest first; those of other processes arrive late and are put where they belong."""
        return sorted(self._events, key=lambda event: event.at)

    @property
    def spans(self) -> list[Event]:
        """The begin and end of callbacks, oldest first."""
        return sorted(self._spans, key=lambda event: event.at)

    def observe(self, event: Event) -> None:
        (self._spans if event.kind in SPAN_KINDS else self._events).append(event)

    def restart(self) -> None:
        self._events.clear()
        self._spans.clear()
