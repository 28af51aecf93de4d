"""What happens while a launch runs, and the actions that wait for it or make it happen."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Union

from course_kit.launch.action import Action, as_entities, execute_all
from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.launch.context import LaunchContext
    from course_kit.launch.substitutions import Condition

# Actions, or a function that is called with the event and the context and returns actions, or nothing.
Reaction = Union[object, Callable[[Any, Any], object]]  # noqa: UP007 - evaluated at run time on Python 3.10, too


@dataclass
class LaunchEvent:
    """Something that has happened."""


@dataclass
class Shutdown(LaunchEvent):
    """The launch ends, with all its processes."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass
class RunningProcessEvent(LaunchEvent):
    """Something about a process."""

    action: Action
    process_name: str
    cmd: list[str] = field(default_factory=list)
    cwd: str | None = None
    env: dict[str, str] = field(default_factory=dict)
    pid: int = 0


@dataclass
class ProcessStarted(RunningProcessEvent):
    """A process has started."""


@dataclass
class ProcessExited(RunningProcessEvent):
    """A process has ended; the return code is the negative number of the signal that has ended it."""

    returncode: int = 0


class EventHandler(LaunchEntity):
    """Actions for an event."""

    def __init__(self, kind: type[LaunchEvent], reaction: Reaction) -> None:
        self._kind, self.reaction = kind, reaction

    def matches(self, event: LaunchEvent) -> bool:
        """Whether an event is meant."""
        return isinstance(event, self._kind)

    def handle(self, event: LaunchEvent, context: LaunchContext) -> object:
        """The actions to be done."""
        return self.reaction(event, context) if callable(self.reaction) else self.reaction


class _OfAProcess(EventHandler):
    """Actions for an event of one process, or of any."""

    def __init__(self, kind: type[RunningProcessEvent], target: object, reaction: Reaction) -> None:
        if target is not None and not isinstance(target, Action):
            raise LaunchError(f"{type(self).__name__}(target_action={target!r}): expected a Node or an ExecuteProcess.")
        super().__init__(kind, reaction)
        self._target = target

    def matches(self, event: LaunchEvent) -> bool:
        """Whether an event is meant."""
        return super().matches(event) and (self._target is None or getattr(event, "action", None) is self._target)


class OnProcessStart(_OfAProcess):
    """Actions for the start of a process."""

    def __init__(self, *, on_start: Reaction, target_action: object = None) -> None:
        super().__init__(ProcessStarted, target_action, on_start)


class OnProcessExit(_OfAProcess):
    """Actions for the end of a process."""

    def __init__(self, *, on_exit: Reaction, target_action: object = None) -> None:
        super().__init__(ProcessExited, target_action, on_exit)


class OnShutdown(EventHandler):
    """Actions for the end of the launch."""

    def __init__(self, *, on_shutdown: Reaction) -> None:
        super().__init__(Shutdown, on_shutdown)


class RegisterEventHandler(Action):
    """From here on, an event has consequences."""

    def __init__(self, event_handler: EventHandler, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Register it."""
        context.service.register(self.event_handler, context)

    def sub_entities(self) -> list[object]:
        """The actions that may follow."""
        return [] if callable(self.event_handler.reaction) else as_entities(self.event_handler.reaction)


class EmitEvent(Action):
    """An event, such as Shutdown."""

    def __init__(self, *, event: LaunchEvent, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Tell those who wait for it."""
        context.service.emit(self.event)


class ShutdownAction(EmitEvent):
    """`launch.actions.Shutdown`: the end of the launch, with all its processes."""

    def __init__(self, *, reason: str = "reason not given", condition: Condition | None = None) -> None:
        super().__init__(event=Shutdown(reason), condition=condition)


class EventDispatcher:
    """The events that have happened, and the handlers that wait for one."""

    def __init__(self) -> None:
        self._events: deque[LaunchEvent] = deque()
        self._handlers: list[tuple[EventHandler, LaunchContext]] = []

    def register(self, handler: EventHandler, context: LaunchContext) -> None:
        """Have an event handled from now on, with this context for what is done."""
        self._handlers.append((handler, context))

    def emit(self, event: LaunchEvent) -> None:
        """Have an event handled as soon as what is being done is done."""
        self._events.append(event)

    def handled(self) -> Iterator[LaunchEvent]:
        """Handle the events there are, and those that come of it; each, when its handlers are through."""
        while self._events:
            event = self._events.popleft()
            for handler, context in [entry for entry in self._handlers if entry[0].matches(event)]:
                execute_all(handler.handle(event, context), context)
            yield event
