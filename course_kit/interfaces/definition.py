"""What a definition says, once read: messages, and the messages a service or an action is made of."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from course_kit.interfaces.field_types import FieldType

# rosidl gives a message without fields this member on the wire, since C has no empty struct.
EMPTY_MEMBER = "structure_needs_at_least_one_member"


class TypeName(NamedTuple):
    """A full interface name: package, folder (msg, srv or action) and the name itself."""

    package: str
    kind: str
    name: str

    def __str__(self) -> str:
        return f"{self.package}/{self.kind}/{self.name}"


class Line(NamedTuple):
    """Where something stands in the text, for error messages."""

    number: int
    text: str


@dataclass(frozen=True)
class Field:
    """One field; `default` is None, a Python value, or a list of values for an array."""

    name: str
    type: FieldType
    default: Any = None
    line: Line = field(default=Line(0, ""), compare=False)


@dataclass(frozen=True)
class Constant:
    """One constant, such as `string CELSIUS=celsius`."""

    name: str
    type: FieldType
    value: Any  # by its type


@dataclass(frozen=True)
class MessageDefinition:
    """A message, or one of the parts of a service or an action."""

    name: TypeName
    module: str
    fields: tuple[Field, ...] = ()
    constants: tuple[Constant, ...] = ()


@dataclass(frozen=True)
class ServiceDefinition:
    """A service: its request and response, and the event that service introspection publishes."""

    name: TypeName
    module: str
    request: MessageDefinition
    response: MessageDefinition
    event: MessageDefinition = field(init=False)

    def __post_init__(self) -> None:
        """Derive the event message as rosidl_parser does."""
        fields = (
            Field("info", FieldType("service_msgs/msg/ServiceEventInfo")),
            Field("request", FieldType(str(self.request.name), "sequence", 1)),
            Field("response", FieldType(str(self.response.name), "sequence", 1)),
        )
        event = MessageDefinition(_with_suffix(self.name, "_Event"), self.module, fields)
        object.__setattr__(self, "event", event)


@dataclass(frozen=True)
class ActionDefinition:
    """An action: goal, result and feedback, and the two services and the message rosidl derives from them."""

    name: TypeName
    module: str
    goal: MessageDefinition
    result: MessageDefinition
    feedback: MessageDefinition

    @property
    def send_goal(self) -> ServiceDefinition:
        """The service a goal is sent with."""
        request = (_goal_id(), Field("goal", FieldType(str(self.goal.name))))
        response = (Field("accepted", FieldType("boolean")), Field("stamp", FieldType("builtin_interfaces/msg/Time")))
        return self._service("_SendGoal", request, response)

    @property
    def get_result(self) -> ServiceDefinition:
        """The service a result is fetched with."""
        response = (Field("status", FieldType("int8")), Field("result", FieldType(str(self.result.name))))
        return self._service("_GetResult", (_goal_id(),), response)

    @property
    def feedback_message(self) -> MessageDefinition:
        """The message on the action's feedback topic."""
        fields = (_goal_id(), Field("feedback", FieldType(str(self.feedback.name))))
        return MessageDefinition(_with_suffix(self.name, "_FeedbackMessage"), self.module, fields)

    def _service(self, suffix: str, request: tuple[Field, ...], response: tuple[Field, ...]) -> ServiceDefinition:
        name = _with_suffix(self.name, suffix)
        return ServiceDefinition(
            name,
            self.module,
            MessageDefinition(_with_suffix(name, "_Request"), self.module, request),
            MessageDefinition(_with_suffix(name, "_Response"), self.module, response),
        )


Definition = MessageDefinition | ServiceDefinition | ActionDefinition


def module_name(name: str) -> str:
    """The module rosidl_generator_py puts a type in: "AddTwoInts" -> "_add_two_ints"."""
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return "_" + re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def _with_suffix(name: TypeName, suffix: str) -> TypeName:
    return name._replace(name=name.name + suffix)


def _goal_id() -> Field:
    return Field("goal_id", FieldType("unique_identifier_msgs/msg/UUID"))
