"""Which actions wait for an event, and the actions that make them wait or make an event happen."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Union

from course_kit.launch.action import Action, as_entities
from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError
from course_kit.launch.events import (
    ExecutionComplete,
    LaunchEvent,
    Matcher,
    ProcessExited,
    ProcessIO,
    ProcessStarted,
    RunningProcessEvent,
    Shutdown,
)

if TYPE_CHECKING:
    from course_kit.launch.conditions import Condition
    from course_kit.launch.context import LaunchContext

# Actions, or a function that is called with the event and the context and returns actions, or nothing.
Reaction = Union[object, Callable[[Any, Any], object]]  # noqa: UP007 - evaluated at run time on Python 3.10, too


class EventHandler(LaunchEntity):
    """Actions for an event."""

    def __init__(self, *, matcher: Matcher, entities: Reaction = None, handle_once: bool = False) -> None:
        self._matcher, self.reaction, self.handle_once = matcher, entities, handle_once

    def matches(self, event: LaunchEvent) -> bool:
        """Whether an event is meant."""
        return self._matcher(event)

    def handle(self, event: LaunchEvent, context: LaunchContext) -> object:
        """The actions to be done."""
        return self.reaction(event, context) if callable(self.reaction) else self.reaction


class _OfAnAction(EventHandler):
    """Actions for an event of one action, such as one that starts a process, or of any."""

    def __init__(
        self,
        kind: type[RunningProcessEvent | ExecutionComplete],
        target: object,
        reaction: Reaction,
        *,
        handle_once: bool = False,
    ) -> None:
        if target is not None and not isinstance(target, Action) and not callable(target):
            raise LaunchError(f"{type(self).__name__}(target_action={target!r}): expected a Node or an ExecuteProcess.")

        def is_meant(event: LaunchEvent) -> bool:
            if not isinstance(event, kind):
                return False
            return target is None or event.action is target or (callable(target) and bool(target(event.action)))

        super().__init__(matcher=is_meant, entities=reaction, handle_once=handle_once)


class OnExecutionComplete(_OfAnAction):
    """Actions for when another action is done; one that starts a process is done when the process has ended."""

    def __init__(self, *, on_completion: Reaction, target_action: object = None, handle_once: bool = False) -> None:
        super().__init__(ExecutionComplete, target_action, on_completion, handle_once=handle_once)


class OnProcessStart(_OfAnAction):
    """Actions for the start of a process."""

    def __init__(self, *, on_start: Reaction, target_action: object = None, handle_once: bool = False) -> None:
        super().__init__(ProcessStarted, target_action, on_start, handle_once=handle_once)


class OnProcessExit(_OfAnAction):
    """Actions for the end of a process."""

    def __init__(self, *, on_exit: Reaction, target_action: object = None, handle_once: bool = False) -> None:
        super().__init__(ProcessExited, target_action, on_exit, handle_once=handle_once)


class OnProcessIO(_OfAnAction):
    """Functions for what a process writes."""

    def __init__(
        self,
        *,
        target_action: object = None,
        on_stdout: Callable[[ProcessIO], object] | None = None,
        on_stderr: Callable[[ProcessIO], object] | None = None,
        on_stdin: Callable[[ProcessIO], object] | None = None,
    ) -> None:
        del on_stdin

        def react(event: ProcessIO, _: LaunchContext) -> object:
            function = on_stdout if event.from_stdout else on_stderr
            return None if function is None else function(event)

        super().__init__(ProcessIO, target_action, react)


class OnShutdown(EventHandler):
    """Actions for the end of the launch."""

    def __init__(self, *, on_shutdown: Reaction) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown)


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


class UnregisterEventHandler(RegisterEventHandler):
    """From here on, an event has no consequences any more."""

    def execute(self, context: LaunchContext) -> None:
        """Forget it."""
        context.service.unregister(self.event_handler)


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
