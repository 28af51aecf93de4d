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
    """Actions for an event.

    Args:
        matcher: says whether an event is meant.
        entities: what is done then.
        handle_once: whether only for the first such event.
    """

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
    """Actions for when another action is done; one that starts a process is done when the process has ended.

    Args:
        on_completion: the actions, or a function of the event and the context that returns them.
        target_action: the action; any if None.
        handle_once: whether only for the first time.
    """

    def __init__(self, *, on_completion: Reaction, target_action: object = None, handle_once: bool = False) -> None:
        super().__init__(ExecutionComplete, target_action, on_completion, handle_once=handle_once)


class OnProcessStart(_OfAnAction):
    """Actions for the start of a process.

    Args:
        on_start: the actions, or a function of the event and the context that returns them.
        target_action: the Node or ExecuteProcess; any if None.
        handle_once: whether only for the first time.
    """

    def __init__(self, *, on_start: Reaction, target_action: object = None, handle_once: bool = False) -> None:
        super().__init__(ProcessStarted, target_action, on_start, handle_once=handle_once)


class OnProcessExit(_OfAnAction):
    """Actions for the end of a process.

    Args:
        on_exit: the actions, or a function of the event and the context that returns them.
        target_action: the Node or ExecuteProcess; any if None.
        handle_once: whether only for the first time.
    """

    def __init__(self, *, on_exit: Reaction, target_action: object = None, handle_once: bool = False) -> None:
        super().__init__(ProcessExited, target_action, on_exit, handle_once=handle_once)


class OnProcessIO(_OfAnAction):
    """Functions for what a process writes.

    Args:
        target_action: the Node or ExecuteProcess; any if None.
        on_stdout: called with the event of each line on stdout; may return actions.
        on_stderr: the same for stderr.
        on_stdin: taken for the file's sake; nothing is ever written to a process here.
    """

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
    """Actions for the end of the launch.

    Args:
        on_shutdown: the actions, or a function of the event and the context that returns them.
    """

    def __init__(self, *, on_shutdown: Reaction) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown)


class RegisterEventHandler(Action):
    """From here on, an event has consequences.

    Args:
        event_handler: such as OnProcessExit.
        condition: it is only done if this holds then.
    """

    def __init__(self, event_handler: EventHandler, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Register it.

        Raises:
            LaunchError: it needs what processes write, where nobody reads that.
        """
        context.service.register(self.event_handler, context)

    def sub_entities(self) -> list[object]:
        """The actions that may follow."""
        return [] if callable(self.event_handler.reaction) else as_entities(self.event_handler.reaction)


class UnregisterEventHandler(RegisterEventHandler):
    """From here on, an event has no consequences any more.

    Args:
        event_handler: what was registered.
        condition: it is only done if this holds then.
    """

    def execute(self, context: LaunchContext) -> None:
        """Forget it."""
        context.service.unregister(self.event_handler)


class EmitEvent(Action):
    """An event, such as Shutdown.

    Args:
        event: the event.
        condition: it is only done if this holds then.
    """

    def __init__(self, *, event: LaunchEvent, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        """Tell those who wait for it."""
        context.service.emit(self.event)


class ShutdownAction(EmitEvent):
    """`launch.actions.Shutdown`: the end of the launch, with all its processes.

    Args:
        reason: why.
        condition: it is only done if this holds then.
    """

    def __init__(self, *, reason: str = "reason not given", condition: Condition | None = None) -> None:
        super().__init__(event=Shutdown(reason), condition=condition)
