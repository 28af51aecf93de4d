"""The properties through which the fields of a message are read and set, with the checks on the way.

The setters are generated code, as those of compiled classes are: a program sets fields all the time. They know the
usual kind of value themselves; any other goes to the check of `field_checks`, which accepts or refuses it.
"""

from __future__ import annotations

import array
import operator
from typing import TYPE_CHECKING, Any

from course_kit.interfaces.field_checks import field_check, largest_float

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.interfaces.field_types import FieldType, Primitive
    from course_kit.interfaces.message_fields import MessageField

_CHECKED = """
def {name}(self, value):
    if self._check_fields and ({unusual}):
        check(value)
    self._{name} = value
"""
_NUMBERS = """
def {name}(self, value):
    if self._check_fields:
        if value.__class__ is not container or {unusual}:
            check(value)
            if not isinstance(value, container):
                value = convert(value)
    else:
        value = convert(value)
    self._{name} = value
"""


def field_property(field: MessageField) -> property:
    """Make the property of a field, whose value is kept in the slot of the same name with an underscore."""
    names: dict[str, Any] = {"check": field_check(field)}
    if field.type.is_numeric_container and field.type.primitive:
        source = _numbers(field.type, field.type.primitive, names)
    else:
        source = _CHECKED.replace("{unusual}", _unusual(field, names))
    exec(compile(source.replace("{name}", field.name), f"<field {field.name}>", "exec"), names)  # noqa: S102
    setter: Callable[[Any, Any], None] = names[field.name]
    return property(operator.attrgetter(f"_{field.name}"), setter, doc=f"Message field '{field.name}'.")


def _unusual(field: MessageField, names: dict[str, Any]) -> str:
    """Code that tells whether a value has to be looked at more closely."""
    kind, primitive = field.type, field.type.primitive
    if kind.container or kind.string_bound or kind.base == "octet":
        return "True"
    names["usual"] = field.nested or (primitive.python if primitive else str)
    unusual = "value.__class__ is not usual"
    if primitive and primitive.integer_range:
        smallest, largest = primitive.integer_range
        return f"{unusual} or not {smallest} <= value <= {largest}"
    if primitive and primitive.python is float:
        names["most"] = largest_float(primitive)
        return f"{unusual} or not -most <= value <= most"
    return unusual


def _numbers(kind: FieldType, primitive: Primitive, names: dict[str, Any]) -> str:
    """The setter of a field that keeps its numbers in an array.array, or those of a fixed array in one of numpy."""
    code = primitive.array_code
    if kind.container == "sequence":
        names |= {"container": array.array, "convert": lambda value: array.array(code, value)}
        unusual = f"value.typecode != {code!r}" + (f" or len(value) > {kind.size}" if kind.size else "")
    else:
        import numpy as np  # here, since most messages have no fixed array

        dtype = np.dtype(primitive.numpy)
        names |= {"container": np.ndarray, "dtype": dtype, "convert": lambda value: np.array(value, dtype=dtype)}
        unusual = f"value.dtype != dtype or value.size != {kind.size}"
    return _NUMBERS.replace("{unusual}", unusual)
