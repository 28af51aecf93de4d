"""A launch file, what it describes, how its actions are done one after the other, and what happens meanwhile."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from typing import TYPE_CHECKING, Any, Union

from course_kit.launch.entity import LaunchContext, LaunchEntity
from course_kit.launch.errors import LaunchError, in_a_sentence, place_in

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.launch.substitutions import Condition, Text

_GENERATE = "generate_launch_description"
_OTHER_KINDS = {".xml": "XML", ".launch": "XML, as ROS 1 has them,", ".yaml": "YAML", ".yml": "YAML"}


class LaunchDescription:
    """The actions of a launch file, in order."""

    def __init__(self, initial_entities: Iterable[object] | None = None) -> None:
        self.entities = list(initial_entities or [])

    def add_action(self, action: object) -> None:
        self.entities.append(action)


class Action(LaunchEntity):
    """Something a launch file does."""

    condition: Condition | None = None

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.condition = condition

    def execute(self, context: LaunchContext) -> object:
        """Do it; what is returned is done after it."""
        raise NotImplementedError(type(self).__name__)

    def sub_entities(self) -> Iterable[object]:
        """Actions that may come of it, as far as is known before it is done."""
        return ()


class PythonLaunchDescriptionSource(LaunchEntity):
    """A launch file to include."""

    def __init__(self, launch_file_path: Text) -> None:
        self.launch_file_path = launch_file_path


# Actions, or a function that is called with the event and the context and returns actions, or nothing.
Reaction = Union[object, Callable[[Any, Any], object]]  # noqa: UP007 - evaluated at run time on Python 3.10, too


@dataclass
class Shutdown:
    """The launch ends, with all its processes."""

    reason: str = "reason not given"


@dataclass
class ProcessExited:
    """A process has ended; the return code is the negative number of the signal that has ended it."""

    action: Action
    process_name: str
    cmd: list[str]
    pid: int = 0
    returncode: int = 0


class OnProcessExit(LaunchEntity):
    """Actions for the end of one process, or of any."""

    def __init__(self, *, on_exit: Reaction, target_action: object = None) -> None:
        if target_action is not None and not isinstance(target_action, Action):
            raise LaunchError(f"OnProcessExit(target_action={target_action!r}): expected a Node or an ExecuteProcess.")
        self.reaction, self._target = on_exit, target_action

    def matches(self, event: object) -> bool:
        return isinstance(event, ProcessExited) and self._target in (None, event.action)

    def handle(self, event: object, context: LaunchContext) -> object:
        return self.reaction(event, context) if callable(self.reaction) else self.reaction


class RegisterEventHandler(Action):
    """From here on, an event has consequences."""

    def __init__(self, event_handler: OnProcessExit, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event_handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        context.service.register(self.event_handler, context)

    def sub_entities(self) -> list[object]:
        return [] if callable(self.event_handler.reaction) else as_entities(self.event_handler.reaction)


class EmitEvent(Action):
    """An event, which is `Shutdown`."""

    def __init__(self, *, event: Shutdown, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.event = event

    def execute(self, context: LaunchContext) -> None:
        context.service.emit(self.event)


class ShutdownAction(EmitEvent):
    """`launch.actions.Shutdown`: the end of the launch, with all its processes."""

    def __init__(self, *, reason: str = "reason not given", condition: Condition | None = None) -> None:
        super().__init__(event=Shutdown(reason), condition=condition)


def execute_all(entities: object, context: LaunchContext) -> None:
    """Do actions in order, those whose condition holds."""
    for entity in as_entities(entities):
        if isinstance(entity, LaunchDescription):
            execute_all(entity.entities, context)
        elif isinstance(entity, Action):
            execute_all(_done(entity, context), context)
        else:
            raise LaunchError(f"{entity!r} is not part of the course kit's subset of launch.")


def as_entities(entities: object) -> list[object]:
    """One or many of them, as a list."""
    if entities is None:
        return []
    if isinstance(entities, Iterable) and not isinstance(entities, str):
        return list(entities)
    return [entities]


def _done(action: Action, context: LaunchContext) -> object:
    try:
        holds = action.condition is None or action.condition.evaluate(context)
        return action.execute(context) if holds else None
    except LaunchError as error:
        raise error.add_place(action.place) from None
    except Exception as error:
        raise in_a_sentence(error, context.file) from error


def load_description(path: Path) -> LaunchDescription:
    """What a launch file describes."""
    if path.suffix in _OTHER_KINDS:
        raise LaunchError(
            f"{path.name} is a launch file in {_OTHER_KINDS[path.suffix]}. The course reads launch files in Python "
            "only; a full ROS 2 installation reads this one, too."
        )
    if not path.is_file():
        raise LaunchError(f"There is no launch file {path}.")
    spec = spec_from_file_location(f"launch_file_{path.name.partition('.')[0]}", path)
    if path.suffix != ".py" or spec is None or spec.loader is None:
        raise LaunchError(f"{path} is not a launch file in Python, *.launch.py.")
    module = module_from_spec(spec)
    writes, sys.dont_write_bytecode = sys.dont_write_bytecode, True  # no __pycache__ beside the learner's file
    try:
        spec.loader.exec_module(module)
        generate = getattr(module, _GENERATE, None)
        description = generate() if callable(generate) else None
    except LaunchError as error:
        raise error.add_place(place_in(path, error)) from None
    except SystemExit as leaving:
        raise LaunchError(f"The launch file ends itself, with sys.exit({leaving.code!r}).", path.name) from None
    except Exception as error:
        raise in_a_sentence(error, path) from error
    finally:
        sys.dont_write_bytecode = writes
    if not isinstance(description, LaunchDescription):
        raise LaunchError(f"{path.name} has no function {_GENERATE}() that returns a LaunchDescription.")
    return description
