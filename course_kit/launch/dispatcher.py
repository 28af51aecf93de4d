"""Events of a launch on their way to those who wait for them."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from course_kit.launch.action import execute_all

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.launch.context import LaunchContext
    from course_kit.launch.event_handlers import EventHandler
    from course_kit.launch.events import LaunchEvent


class EventDispatcher:
    """The events that have happened, and the handlers that wait for one."""

    def __init__(self) -> None:
        self._events: deque[LaunchEvent] = deque()
        self._handlers: list[tuple[EventHandler, LaunchContext]] = []

    @property
    def is_awaited(self) -> bool:
        """Whether anybody waits for any event."""
        return bool(self._handlers)

    def register(self, handler: EventHandler, context: LaunchContext) -> None:
        """Have an event handled from now on."""
        self._handlers.append((handler, context))

    def unregister(self, handler: EventHandler) -> None:
        """Have an event handled no more."""
        self._handlers = [entry for entry in self._handlers if entry[0] is not handler]

    def emit(self, event: LaunchEvent) -> None:
        """Have an event handled as soon as what is being done is done."""
        self._events.append(event)

    def handled(self) -> Iterator[LaunchEvent]:
        """Handle the events there are, and those that come of it; each, when its handlers are through."""
        while self._events:
            event = self._events.popleft()
            for handler, context in [entry for entry in self._handlers if entry[0].matches(event)]:
                if handler.handle_once:
                    self.unregister(handler)
                inside = context.handling(event)
                execute_all(handler.handle(event, inside), inside)
            yield event
