"""The parameters that a launch file gives to a node: values of each type, as ROS 2 reads them, and files."""

from __future__ import annotations

import typing
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import yaml

from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError
from course_kit.launch.substitutions import Substitution, Text, as_text, has_substitution

if TYPE_CHECKING:
    from course_kit.launch.context import LaunchContext

_PLAIN = (bool, int, float, str)
_EXPECTED = "expected a bool, int, float, str or a list of one of these"


class ParameterValue(LaunchEntity):
    """A parameter's value with its type."""

    def __init__(self, value: object, *, value_type: Any = None) -> None:
        self.value, self.value_type = value, value_type

    def evaluate(self, context: LaunchContext) -> object:
        """The value."""
        kind = self.value_type
        if kind is None:
            return value_of("", self.value, context)
        text = as_text(self.value, context) if _is_text(self.value) else None
        if kind is str and text is not None:
            return text
        read = value_of("", self.value, context) if text is None else _read("", text)
        inner = typing.get_args(kind)
        try:
            if inner:
                return [_converted(part, inner[0]) for part in typing.cast("Iterable[object]", read)]
            return _converted(read, kind)
        except (TypeError, ValueError):
            raise LaunchError(f"ParameterValue({text or read!r}) is no {getattr(kind, '__name__', kind)}.") from None


class ParameterFile(LaunchEntity):
    """A parameter file."""

    def __init__(self, param_file: Text, *, allow_substs: Text | bool = False) -> None:
        self.path, self.allow_substs = param_file, allow_substs


class Parameter(LaunchEntity):
    """A parameter by its name and value."""

    def __init__(self, name: Text, value: object, *, value_type: Any = None) -> None:
        self.name, self.value = name, ParameterValue(value, value_type=value_type)


def values_of(parameters: Mapping[Any, Any], context: LaunchContext, before: str = "") -> dict[str, object]:
    """The values of a dict of parameters; those of a dict within it have dotted names."""
    found: dict[str, object] = {}
    for key, value in parameters.items():
        name = before + as_text(key, context)
        if isinstance(value, Mapping):
            found |= values_of(value, context, f"{name}.")
        else:
            found[name] = value_of(name, value, context)
    return found


def value_of(name: str, value: object, context: LaunchContext) -> object:
    """One value; what substitutions bring is read as YAML, as typed on a command line."""
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if has_substitution(value) and _is_text(value):
        return _read(name, as_text(value, context))
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, (list, tuple)):
        return _of_one_type(name, [_element(name, part, context) for part in value])
    raise LaunchError(f"Parameter '{name}' has the value {value!r}: {_EXPECTED}.")


def _element(name: str, part: object, context: LaunchContext) -> object:
    """An element of a list: as it is, or read if it is made of substitutions and texts."""
    return _read(name, as_text(part, context)) if isinstance(part, (Substitution, list, tuple)) else part


def _is_text(value: object) -> bool:
    """Whether it becomes one text: a substitution, or a list of substitutions and texts."""
    if isinstance(value, (str, Substitution)):
        return True
    return isinstance(value, (list, tuple)) and all(isinstance(part, (str, Substitution)) for part in value)


def _read(name: str, text: str) -> object:
    """What YAML makes of a text; an empty one stays one."""
    whose = f"Parameter '{name}'" if name else "The parameter"
    as_it_is = "To have the text as it is, write ParameterValue(..., value_type=str)."
    if not text:
        return ""
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        raise LaunchError(f"{whose} has the value {text!r}, which YAML cannot read. {as_it_is}") from None
    if isinstance(value, list):
        return _of_one_type(name, value)
    if not isinstance(value, _PLAIN):
        raise LaunchError(f"{whose} has the value {text!r}: {_EXPECTED}. {as_it_is}")
    return value


def _of_one_type(name: str, values: list[object]) -> list[object]:
    """The elements of a list; whole numbers among others become floats, as in ROS 2."""
    kinds = {type(value) for value in values}
    if kinds == {int, float}:
        return [float(value) for value in values]  # type: ignore[arg-type]
    if not values:
        raise LaunchError(f"Parameter '{name}' is an empty list, whose type ROS 2 cannot know: leave it out.")
    if len(kinds) > 1 or not kinds <= set(_PLAIN):
        raise LaunchError(f"Parameter '{name}' has the value {values!r}: all elements of a list have one type.")
    return values


def _converted(value: object, kind: type) -> object:
    if kind is bool or isinstance(value, bool):
        if kind is bool and isinstance(value, bool):
            return value
        raise TypeError
    if kind is int and isinstance(value, float):
        raise TypeError
    if kind is str:
        return str(value)
    return kind(value)
