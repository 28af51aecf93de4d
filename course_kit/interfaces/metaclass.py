"""The metaclass of a live class: rclpy looks for a type's support there, as rosidl_generator_py has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.interfaces.live_record import class_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.interfaces.definition import Definition


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


def _import_type_support(metaclass: type) -> None:
    from course_kit.interfaces.type_support import add_support

    add_support(class_of(metaclass))
