"""What a definition says, once read: messages, and the messages a service or an action is made of."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from rosidl_parser import definition as rosidl


class Primitive(NamedTuple):
    """A basic type of IDL and all its names: what ROS 2 calls it in each place."""

    idl: str
    format: str  # of the struct module
    size: int  # bytes on the wire, which is its alignment too
    python: type
    array_code: str  # array.array's; "" where a plain list is used
    introspection_id: int  # rosidl_typesupport_introspection_c
    description_id: int  # type_description_interfaces/msg/FieldType

    @property
    def numpy(self) -> str:
        """Name of the numpy dtype that holds a fixed array of it, "" where a plain list is used."""
        if not self.array_code:
            return ""
        return {"float": "float32", "double": "float64"}.get(self.idl, self.idl)

    @property
    def integer_range(self) -> tuple[int, int] | None:
        """Smallest and largest value, None unless an integer."""
        if self.python is not int:
            return None
        bits = 8 * self.size
        return (0, 2**bits - 1) if self.idl.startswith("u") else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


PRIMITIVES = {
    primitive.idl: primitive
    for primitive in (
        Primitive("float", "f", 4, float, "f", 1, 10),
        Primitive("double", "d", 8, float, "d", 2, 11),
        Primitive("boolean", "?", 1, bool, "", 6, 15),
        Primitive("octet", "c", 1, bytes, "", 7, 16),
        Primitive("uint8", "B", 1, int, "B", 8, 3),
        Primitive("int8", "b", 1, int, "b", 9, 2),
        Primitive("uint16", "H", 2, int, "H", 10, 5),
        Primitive("int16", "h", 2, int, "h", 11, 4),
        Primitive("uint32", "I", 4, int, "I", 12, 7),
        Primitive("int32", "i", 4, int, "i", 13, 6),
        Primitive("uint64", "Q", 8, int, "Q", 14, 9),
        Primitive("int64", "q", 8, int, "q", 15, 8),
    )
}
STRINGS = ("string", "wstring")


class FieldType(NamedTuple):
    """Type of one field."""

    base: str
    container: str = ""
    size: int = 0
    string_bound: int = 0

    @property
    def primitive(self) -> Primitive | None:
        """The basic type of a value, None for strings and nested messages."""
        return PRIMITIVES.get(self.base)

    @property
    def is_string(self) -> bool:
        """Whether a value is a string or wstring."""
        return self.base in STRINGS

    @property
    def is_nested(self) -> bool:
        """Whether a value is another message."""
        return "/" in self.base

    @property
    def element(self) -> FieldType:
        """The type of one element."""
        return self._replace(container="", size=0)

    @property
    def is_numeric_container(self) -> bool:
        """Whether values live in a numpy array (fixed size) or an array.array (sequence)."""
        return bool(self.container and self.primitive and self.primitive.array_code)

    def __str__(self) -> str:
        """The spelling of `get_fields_and_field_types()`."""
        if self.is_nested:
            package, _, name = self.base.split("/")
            value = f"{package}/{name}"
        else:
            value = f"{self.base}<{self.string_bound}>" if self.string_bound else self.base
        if self.container == "array":
            return f"{value}[{self.size}]"
        if self.container == "sequence":
            return f"sequence<{value}, {self.size}>" if self.size else f"sequence<{value}>"
        return value


def from_slot_type(slot: rosidl.AbstractType) -> FieldType:
    """Translate one of a class's SLOT_TYPES."""
    value = slot.value_type if isinstance(slot, rosidl.AbstractNestedType) else slot
    bound = 0
    if isinstance(value, rosidl.BasicType):
        base = value.typename
    elif isinstance(value, rosidl.NamespacedType):
        base = "/".join((*value.namespaces, value.name))
    else:
        base = "wstring" if isinstance(value, rosidl.AbstractWString) else "string"
        bound = value.maximum_size if value.has_maximum_size() else 0
    if isinstance(slot, rosidl.Array):
        return FieldType(base, "array", slot.size, bound)
    if isinstance(slot, rosidl.AbstractNestedType):
        return FieldType(base, "sequence", slot.maximum_size if slot.has_maximum_size() else 0, bound)
    return FieldType(base, string_bound=bound)


def to_slot_type(field: FieldType) -> rosidl.AbstractType:
    """Make the object a message class carries in SLOT_TYPES."""
    value = _slot_value(field)
    if field.container == "array":
        return rosidl.Array(value, field.size)
    if field.container == "sequence":
        return rosidl.BoundedSequence(value, field.size) if field.size else rosidl.UnboundedSequence(value)
    return value


def _slot_value(field: FieldType) -> rosidl.AbstractNestableType:
    if field.is_nested:
        *namespaces, name = field.base.split("/")
        return rosidl.NamespacedType(namespaces, name)
    if field.base == "string":
        return rosidl.BoundedString(field.string_bound) if field.string_bound else rosidl.UnboundedString()
    if field.base == "wstring":
        return rosidl.BoundedWString(field.string_bound) if field.string_bound else rosidl.UnboundedWString()
    return rosidl.BasicType(field.base)


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


_GOAL_ID = Field("goal_id", FieldType("unique_identifier_msgs/msg/UUID"))


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
    """A service: its request and response."""

    name: TypeName
    module: str
    request: MessageDefinition
    response: MessageDefinition

    @property
    def event(self) -> MessageDefinition:
        """What service introspection publishes, derived as rosidl_parser does it."""
        fields = (
            Field("info", FieldType("service_msgs/msg/ServiceEventInfo")),
            Field("request", FieldType(str(self.request.name), "sequence", 1)),
            Field("response", FieldType(str(self.response.name), "sequence", 1)),
        )
        return MessageDefinition(_with_suffix(self.name, "_Event"), self.module, fields)


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
        request = (_GOAL_ID, Field("goal", FieldType(str(self.goal.name))))
        response = (Field("accepted", FieldType("boolean")), Field("stamp", FieldType("builtin_interfaces/msg/Time")))
        return self._service("_SendGoal", request, response)

    @property
    def get_result(self) -> ServiceDefinition:
        """The service a result is fetched with."""
        response = (Field("status", FieldType("int8")), Field("result", FieldType(str(self.result.name))))
        return self._service("_GetResult", (_GOAL_ID,), response)

    @property
    def feedback_message(self) -> MessageDefinition:
        """The message on the action's feedback topic."""
        fields = (_GOAL_ID, Field("feedback", FieldType(str(self.feedback.name))))
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
