"""The live types of this process: made from their texts when first wanted, made anew when defined anew."""

from __future__ import annotations

import importlib
import threading
from typing import TYPE_CHECKING, NoReturn

from course_kit.interfaces import hints
from course_kit.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition, TypeName
from course_kit.interfaces.errors import InterfaceDefinitionError
from course_kit.interfaces.message_class import make_message_class, make_metaclass, python_module
from course_kit.interfaces.message_fields import keep_record, message_class
from course_kit.interfaces.parser import parse_definition

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.interfaces.definition import Definition, Field


class BuiltDefinition:
    """The classes one definition has led to."""

    def __init__(self, text: str, definition: Definition, nested: dict[str, type]) -> None:
        self.text, self.module, self.nested = text, definition.module, nested
        self.classes: dict[str, type] = {}

    def find(self, name: str) -> type | None:
        """A class or its metaclass by the name it has in its module, or None."""
        cls = self.classes.get(name.removeprefix("Metaclass_"))
        return type(cls) if cls is not None and name.startswith("Metaclass_") else cls


class Library:
    """Makes and keeps live types."""

    def __init__(self, find_text: Callable[[TypeName], str | None]) -> None:
        self._find_text = find_text
        self._built: dict[TypeName, BuiltDefinition] = {}
        self._being_built: list[TypeName] = []
        self._lock = threading.RLock()

    def get(self, name: TypeName) -> BuiltDefinition | None:
        """The live type of that name, made if need be; None if there is no text for it."""
        with self._lock:
            if name in self._being_built:
                raise InterfaceDefinitionError(str(name), 0, "", "A message cannot contain itself, directly or not.")
            if name not in self._built:
                text = self._find_text(name)
                if text is None:
                    return None
                self._built[name] = self._build(name, text)
            return self._built[name]

    def define(self, name: TypeName, text: str) -> BuiltDefinition:
        """Make a type from a text given now; the types that contain it are made anew when next wanted."""
        with self._lock:
            known = self._built.get(name)
            if known is not None and known.text == text:
                return known
            built = self._build(name, text)  # first, so that an invalid text changes nothing
            self._forget(name)
            self._built[name] = built
            return built

    def names(self) -> list[TypeName]:
        """The types that have been made."""
        return list(self._built)

    def _forget(self, name: TypeName) -> None:
        """Drop a type and, one after another, those that contain it."""
        self._built.pop(name, None)
        for other in [other for other, built in self._built.items() if str(name) in built.nested]:
            self._forget(other)

    def _build(self, name: TypeName, text: str) -> BuiltDefinition:
        definition = parse_definition(str(name), text)
        self._being_built.append(name)
        try:
            fields = (field for part in _parts(definition) for field in part.fields if field.type.is_nested)
            nested = {field.type.base: self._nested_class(name, field) for field in fields}
        finally:
            self._being_built.pop()
        return _build_classes(BuiltDefinition(text, definition, nested), definition)

    def _nested_class(self, owner: TypeName, field: Field) -> type:
        """The class of a field's messages, live or compiled."""
        if self._contains(field.type.base, owner):
            expected = "Expected another type: a message cannot contain itself, directly or not."
            raise InterfaceDefinitionError(str(owner), field.line.number, field.line.text, expected)
        package, _, name = field.type.base.split("/")
        try:
            return message_class(field.type.base)
        except (ImportError, AttributeError):
            expected = _no_message(package, name)
            raise InterfaceDefinitionError(str(owner), field.line.number, field.line.text, expected) from None

    def _contains(self, full_name: str, wanted: TypeName) -> bool:
        """Whether a message that has been made is, or contains, the wanted one."""
        built = self._built.get(TypeName(*full_name.split("/")))
        return full_name == str(wanted) or (built is not None and any(self._contains(n, wanted) for n in built.nested))


def _no_message(package: str, name: str) -> str:
    """What to say of a message that cannot be found."""
    from course_kit.interfaces import known_types

    wanted = f"{package}/{name}"
    idl = known_types.idl_file(package, name)
    if idl is not None:
        return (
            f"{wanted} exists only as IDL, which the course does not read: {idl}. Expected {name}.msg beside it: write "
            "its fields there, a line each."
        )
    known = [full.replace("/msg/", "/") for full in known_types.types(kind="msg")]
    if name in hints.OTHER_NAMES:
        return f"There is no message {wanted}: did you mean {hints.OTHER_NAMES[name]}?"
    similar = next((full for full in known if full.endswith(f"/{name}")), None) or hints.nearest_name(wanted, known)
    hint = f" Did you mean {similar}?" if similar else f" E{hints.TYPE_EXAMPLES[1:]}"
    return f"There is no message {wanted}.{hint}"


def _parts(definition: Definition) -> tuple[MessageDefinition, ...]:
    if isinstance(definition, ServiceDefinition):
        return definition.request, definition.response
    if isinstance(definition, ActionDefinition):
        return definition.goal, definition.result, definition.feedback
    return (definition,)


def _build_classes(built: BuiltDefinition, definition: Definition) -> BuiltDefinition:
    if isinstance(definition, MessageDefinition):
        _add_message(built, definition, built.text)
    elif isinstance(definition, ServiceDefinition):
        _add_service(built, definition, built.text)
    else:
        _add_action(built, definition)
    return built


def _add_message(built: BuiltDefinition, definition: MessageDefinition, text: str | None = None) -> type:
    """Make the class of a message whose nested messages are those of the definition, its own parts, or ROS's."""
    nested = {}
    for field in definition.fields:
        if field.type.is_nested:
            _, kind, name = field.type.base.split("/")
            own = built.classes.get(name) if kind != "msg" else None  # a part of this service or action
            nested[field.type.base] = own or built.nested.get(field.type.base) or message_class(field.type.base)
    cls = make_message_class(definition, nested, text)
    built.classes[definition.name.name] = cls
    return cls


def _add_service(built: BuiltDefinition, definition: ServiceDefinition, text: str | None = None) -> type:
    parts = {"Request": definition.request, "Response": definition.response, "Event": definition.event}
    return _bundle(built, definition, {name: _add_message(built, part) for name, part in parts.items()}, text)


def _add_action(built: BuiltDefinition, definition: ActionDefinition) -> None:
    public = {
        "Goal": _add_message(built, definition.goal),
        "Result": _add_message(built, definition.result),
        "Feedback": _add_message(built, definition.feedback),
    }
    internal = {
        "SendGoalService": _add_service(built, definition.send_goal),
        "GetResultService": _add_service(built, definition.get_result),
        "FeedbackMessage": _add_message(built, definition.feedback_message),
        "CancelGoalService": importlib.import_module("action_msgs.srv").CancelGoal,
        "GoalStatusMessage": importlib.import_module("action_msgs.msg").GoalStatusArray,
    }
    inner = {"__module__": python_module(definition), "__qualname__": f"{definition.name.name}.Impl"}
    _bundle(built, definition, {**public, "Impl": type("Impl", (), {**inner, **internal})}, built.text)


def _bundle(
    built: BuiltDefinition, definition: ServiceDefinition | ActionDefinition, parts: dict[str, type], text: str | None
) -> type:
    """Make the class of a service or an action out of those of its parts."""
    what = "service" if isinstance(definition, ServiceDefinition) else "action"

    def __init__(_: object, *_values: object, **_fields: object) -> NoReturn:  # noqa: N807
        way = f"Write {definition.name.name}.{next(iter(parts))}(...)."
        raise NotImplementedError(f"{what.capitalize()} classes can not be instantiated. {way}")

    cls: type = make_metaclass(definition, what, {})(
        definition.name.name, (), {"__module__": python_module(definition), "__init__": __init__, **parts}
    )
    keep_record(cls, definition.name.kind, text)
    built.classes[definition.name.name] = cls
    return cls
