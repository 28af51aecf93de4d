"""Keeps the latest events, a bounded number of them."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from course_kit.lab.recording.arrows import arrows_of
from course_kit.lab.recording.diagram import Diagram
from course_kit.lab.recording.timeline import SPAN_KINDS, Timeline

if TYPE_CHECKING:
    from course_kit.lab.recording.events import Event

KEPT = 2000  # events; a call has four
DRAWN = 60  # arrows, unless the caller wants another number


class Recording:
    """What has crossed since it began, up to a number of events, and its diagram."""

    def __init__(self) -> None:
        self._events: deque[Event] = deque(maxlen=KEPT)
        self._spans: deque[Event] = deque(maxlen=KEPT)  # apart, so that a fast timer pushes no call out

    @property
    def events(self) -> list[Event]:
        """The events, oldest first; those of other processes arrive late and are put where they belong."""
        return sorted(self._events, key=lambda event: event.at)

    def observe(self, event: Event) -> None:
        (self._spans if event.kind in SPAN_KINDS else self._events).append(event)

    def restart(self) -> None:
        self._events.clear()
        self._spans.clear()

    def diagram(self, last: int | None = None) -> Diagram:
        """Draw the latest arrows, `last` of them at most."""
        arrows = arrows_of(self.events)
        count = DRAWN if last is None else max(0, last)
        return Diagram(arrows[len(arrows) - min(count, len(arrows)) :], left_out=max(0, len(arrows) - count))

    def timeline(self) -> Timeline:
        """Draw which thread was inside which callback, and what waited meanwhile."""
        return Timeline(self.events, sorted(self._spans, key=lambda event: event.at))
