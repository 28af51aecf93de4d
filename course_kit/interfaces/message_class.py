"""Message classes with the behaviour of those rosidl_generator_py makes."""

from __future__ import annotations

import array
import operator
import reprlib
from copy import copy
from typing import TYPE_CHECKING, Any, cast

from course_kit.interfaces.definition import FieldType, to_slot_type
from course_kit.interfaces.field_checks import checks_by_default, field_check
from course_kit.interfaces.message_fields import MessageField, default_text, keep_record, message_fields

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from course_kit.interfaces.definition import Definition, Field, FieldType, MessageDefinition
    from course_kit.interfaces.message_fields import Message


def make_metaclass(definition: Definition, what: str, attributes: Mapping[str, object]) -> type:
    """Make the metaclass of a message, a service or an action."""
    name = definition.name.name
    return type(
        f"Metaclass_{name}",
        (type,),
        {
            "__module__": python_module(definition),
            "__doc__": f"Metaclass of {what} '{name}'.",
            "__setattr__": _refuse_fields,
            "__import_type_support__": classmethod(_import_type_support),
            "_TYPE_SUPPORT": None,
            **attributes,
        },
    )


def _refuse_fields(cls: type, name: str, value: object) -> None:
    """Refuse `Fibonacci.Feedback.sequence = [0]`, which would take the field away from all messages of the type."""
    if isinstance(vars(cls).get(name), property):
        kind = cls.__name__.replace("_", ".")
        raise TypeError(f"{kind} is the type, not a message: make one with {kind}(), then set its {name}.")
    type.__setattr__(cls, name, value)


def python_module(definition: Definition) -> str:
    """The module of a definition's class, such as "my_interfaces.srv._person_info"."""
    return f"{definition.name.package}.{definition.name.kind}.{definition.module}"


def _import_type_support(metaclass: Any) -> None:
    from course_kit.interfaces.type_support import add_support

    add_support(metaclass._live.cls)  # noqa: SLF001 - its record


def field_property(field: MessageField) -> property:
    """Make the property of a field, whose value is kept in the slot of the same name with an underscore."""
    slot, check, kind = f"_{field.name}", field_check(field), field.type
    container = type(_zeros(kind)) if kind.is_numeric_container else None

    def set_field(self: Any, value: Any) -> None:
        if self._check_fields:
            check(value)
        if container and not (self._check_fields and isinstance(value, container)):
            value = _numbers(kind, value)
        setattr(self, slot, value)

    return property(operator.attrgetter(slot), set_field, doc=f"Message field '{field.name}'.")


def _numbers(kind: FieldType, values: Any) -> Any:
    """What a field of numbers keeps them in: an array.array, or an array of numpy where their count is fixed."""
    assert kind.primitive is not None  # noqa: S101 - of numbers
    if kind.container == "sequence":
        return array.array(kind.primitive.array_code, values)
    import numpy as np  # here, since most messages have no fixed array

    return np.array(values, dtype=kind.primitive.numpy)


def _zeros(kind: FieldType) -> Any:
    return _numbers(kind, [0] * (kind.size if kind.container == "array" else 0))


_CHECK_SLOT = "_check_fields"
_CAPSULES = ("_CREATE_ROS_MESSAGE", "_CONVERT_FROM_PY", "_CONVERT_TO_PY", "_DESTROY_ROS_MESSAGE")


def make_message_class(
    definition: MessageDefinition, nested: Mapping[str, type[Message]], text: str | None = None
) -> type[Message]:
    """Make the class of a message, or of a part of a service or an action."""
    fields = tuple(
        MessageField(field.name, field.type, nested.get(field.type.base), default_text(field.default))
        for field in definition.fields
    )
    with_default = {f"{field.name.upper()}__DEFAULT": field for field in definition.fields if field.default is not None}
    defaults = {field.name: field.default for field in with_default.values()}
    values = {constant.name: _python_value(constant.type, constant.value) for constant in definition.constants}
    name = definition.name.name
    metaclass = make_metaclass(
        definition,
        "message",
        {
            **dict.fromkeys(_CAPSULES),
            **{key: _constant(value) for key, value in values.items()},
            **{key: _default(field) for key, field in with_default.items()},
        },
    )
    body: dict[str, object] = {
        "__module__": python_module(definition),
        "__doc__": _documentation(name, list(values)),
        "__slots__": [*(f"_{field.name}" for field in fields), _CHECK_SLOT],
        "_fields_and_field_types": {field.name: str(field.type) for field in fields},
        "SLOT_TYPES": tuple(to_slot_type(field.type) for field in fields),
        "__init__": _initialiser(fields, defaults),
        "__repr__": _repr,
        "__eq__": _equality(fields),
        "__hash__": None,
        "get_fields_and_field_types": classmethod(lambda cls: copy(cls._fields_and_field_types)),
        **values,
        **{key: _python_value(field.type, field.default) for key, field in with_default.items()},
        **{field.name: field_property(field) for field in fields},
    }
    cls = cast("type[Message]", metaclass(name, (), body))
    keep_record(cls, definition.name.kind, text, fields)
    return cls


def _documentation(name: str, constants: Sequence[str]) -> str:
    if not constants:
        return f"Message class '{name}'."
    lines = "\n".join(f"  {constant}" for constant in constants)
    return f"Message class '{name}'.\n\nConstants:\n{lines}"


def _constant(value: object) -> property:
    return property(lambda _: value)


def _default(field: Field) -> property:
    return property(lambda _: _python_value(field.type, field.default))


def _initialiser(fields: Sequence[MessageField], defaults: Mapping[str, Any]) -> Callable[..., None]:
    slots = [(field.name, f"_{field.name}", _initial_value(field, defaults.get(field.name))) for field in fields]
    # rosidl_generator_py turns a list into an array.array before it looks at it, unless there is a default.
    sequences = (field for field in fields if field.type.container == "sequence" and field.name not in defaults)
    number_lists = {field.name: field.type for field in sequences if field.type.is_numeric_container}
    known = {*(name for name, _, _ in slots), _CHECK_SLOT[1:]}
    checked = checks_by_default()

    def __init__(self: Any, *values: Any, **kwargs: Any) -> None:  # noqa: N807
        if values:
            raise TypeError(_takes_names(type(self).__name__, [name for name, _, _ in slots], values))
        self._check_fields = kwargs.get("check_fields", checked)
        if self._check_fields and not kwargs.keys() <= known:
            unknown = ", ".join(sorted(kwargs.keys() - known))
            raise AssertionError(f"Invalid arguments passed to constructor: {unknown}")
        for name, slot, make in slots:
            if name not in kwargs:
                setattr(self, slot, make())
            elif name in number_lists:
                setattr(self, name, _numbers(number_lists[name], kwargs[name]))
            else:
                setattr(self, name, kwargs[name])

    return __init__


def _takes_names(cls: str, names: Sequence[str], values: Sequence[object]) -> str:
    """The error for values without names, which names fields by their order."""
    if not names:
        return f"{cls} has no fields, so it takes no values: write {cls}()."
    meant = ", ".join(f"{name}={reprlib.repr(value)}" for name, value in zip(names, values, strict=False))
    return f"{cls} takes its fields by name: write {cls}({meant})."


def _initial_value(field: MessageField, default: Any) -> Callable[[], object]:
    """A function that makes the value a new message has in a field."""
    kind, primitive = field.type, field.type.primitive
    if default is not None or kind.is_numeric_container:
        first = _python_value(kind, default) if default is not None else _zeros(kind)
        return lambda: copy(first)
    if kind.container == "sequence":
        return list
    make: Callable[[], object] = field.nested or (primitive.python if primitive else str)
    if primitive and primitive.python is bytes:
        make = lambda: b"\0"  # noqa: E731
    if kind.container == "array":
        return lambda: [make() for _ in range(kind.size)]
    return make


def _python_value(kind: FieldType, value: Any) -> object:
    """A parsed constant or default in the form the field keeps it in; a new object each time."""
    if not isinstance(value, list):
        return bytes([value]) if kind.base == "octet" else value
    elements: list[Any] = [bytes([item]) if kind.base == "octet" else item for item in value]
    return _numbers(kind, elements) if kind.is_numeric_container else elements


def _equality(fields: Sequence[MessageField]) -> Callable[[Message, object], bool]:
    slots = [f"_{field.name}" for field in fields]

    def __eq__(self: Message, other: object) -> bool:  # noqa: N807
        if not isinstance(other, self.__class__):
            return False
        differences = (getattr(self, slot) != getattr(other, slot) for slot in slots)
        return not any(gap.any() if hasattr(gap, "any") else gap for gap in differences)  # numpy tells of each element

    return __eq__


def _repr(self: Message) -> str:
    # Also that of a learner's subclass, whose module may have any depth.
    typename = [*self.__class__.__module__.split(".")[:-1], self.__class__.__name__]
    fields = []
    for field in message_fields(type(self)):
        text = repr(getattr(self, field.name))
        if field.type.is_numeric_container and field.type.container == "sequence":
            text = text[len("array('x', ") : -1] or "[]"
        fields.append(f"{field.name}={text}")
    return f"{'.'.join(typename)}({', '.join(fields)})"
