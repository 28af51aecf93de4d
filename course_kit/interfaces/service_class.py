"""Service and action classes with the behaviour of those rosidl_generator_py makes."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, NoReturn

from course_kit.interfaces.live_record import LiveRecord, source_of
from course_kit.interfaces.metaclass import make_metaclass, python_module

if TYPE_CHECKING:
    from course_kit.interfaces.definition import ActionDefinition, ServiceDefinition


def make_service_class(
    definition: ServiceDefinition, request: type, response: type, event: type, text: str | None = None
) -> type:
    """Make the class of a service out of those of its parts."""
    parts = {"Request": request, "Response": response, "Event": event}
    return _bundle(definition, "service", parts, text)


def make_action_class(definition: ActionDefinition, parts: dict[str, type], text: str) -> type:
    """Make the class of an action."""
    internal = {name: parts[name] for name in ("SendGoalService", "GetResultService", "FeedbackMessage")}
    internal["CancelGoalService"] = importlib.import_module("action_msgs.srv").CancelGoal
    internal["GoalStatusMessage"] = importlib.import_module("action_msgs.msg").GoalStatusArray
    inner = {"__module__": python_module(definition), "__qualname__": f"{definition.name.name}.Impl"}
    implementation = type("Impl", (), {**inner, **internal})
    public = {part: parts[part] for part in ("Goal", "Result", "Feedback")}
    return _bundle(definition, "action", {**public, "Impl": implementation}, text)


def _bundle(
    definition: ServiceDefinition | ActionDefinition, what: str, parts: dict[str, type], text: str | None
) -> type:
    def __init__(_: object) -> NoReturn:  # noqa: N807
        raise NotImplementedError(f"{what.capitalize()} classes can not be instantiated")

    cls: type = make_metaclass(definition, what, {})(
        definition.name.name, (), {"__module__": python_module(definition), "__init__": __init__, **parts}
    )
    LiveRecord(source_of(definition.name.kind, text)).attach(cls)
    return cls
