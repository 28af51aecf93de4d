"""The fields of interfaces, read from their definitions: no class is imported, so that ROS need not be running.

What an interface is made of is "request" and "response", "goal", "result" and "feedback", or "message".
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from course_kit.interfaces.sources import PATH_VARIABLE, path_with
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from course_kit.interfaces.definition import MessageDefinition
    from course_kit.interfaces.field_types import FieldType

PARTS = {"srv": ("request", "response"), "action": ("goal", "result", "feedback"), "msg": ("message",)}


class UnknownInterfaceError(LookupError):
    """There is no such interface, or its definition cannot be read; the text is a sentence."""


@dataclass(frozen=True)
class Fields:
    """The fields of one message.

    Attributes:
        name: the message's, as people read it.
        types: the type of each field.
    """

    name: str
    types: Mapping[str, FieldType]

    def problem_of_path(self, path: tuple[str, ...]) -> str:
        """Why there is no such field, or nothing."""
        here: Fields | None = self
        for word in path:
            if here is None or word not in here.types:
                known = {} if here is None else here.types
                return _no_field(word, known, self.name if here is None else here.name)
            here = here.inside(word)
        return ""

    def inside(self, name: str) -> Fields | None:
        """The fields of a message in this one; None for a field that holds no message, or a list of them."""
        kind = self.types[name]
        if not kind.is_nested or kind.container:
            return None
        return fields_of(kind.base)["message"]

    def problem_of_value(self, name: str, value: object) -> str:
        """Why a field takes no such value, or nothing."""
        kind = self.types[name]
        if kind.container:
            return "" if isinstance(value, list) else f"The field '{name}' is a list ({kind}); {value!r} is none."
        if kind.is_nested:
            return f"The field '{name}' is {kind}, so it takes a table of that one's fields, not {value!r}."
        if _takes(kind, value):
            return ""
        return f"The field '{name}' is {_word(kind)}; {value!r} is {_word_of(value)}."


def _no_field(word: str, known: Mapping[str, Any], owner: str) -> str:
    has = f"it has {', '.join(known)}" if known else "it has none"
    return f"There is no field '{word}' in {owner}; {has}.{did_you_mean(word, known)}"


def _takes(kind: FieldType, value: object) -> bool:
    if kind.is_string:
        return isinstance(value, str)
    primitive = kind.primitive
    if primitive is None or primitive.python is bytes:
        return True
    if primitive.python is float:
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    if primitive.python is bool:
        return isinstance(value, bool)
    limits = primitive.integer_range or (0, 0)
    return isinstance(value, int) and not isinstance(value, bool) and limits[0] <= value <= limits[1]


def _word(kind: FieldType) -> str:
    if kind.is_string:
        return "a text"
    return {"double": "a float64", "float": "a float32", "boolean": "a bool"}.get(kind.base, f"an {kind.base}")


def _word_of(value: object) -> str:
    words = {bool: "a truth value", int: "a whole number", float: "a number", str: "a text", list: "a list"}
    return words.get(type(value), "a table" if isinstance(value, dict) else type(value).__name__)


def fields_of(interface: str) -> Mapping[str, Fields]:
    """The fields of an interface, by the parts it is made of.

    Args:
        interface: its full name, "package/srv/Name".

    Raises:
        UnknownInterfaceError: there is none, or its definition has a mistake.
    """
    return _fields_of(interface, os.environ.get(PATH_VARIABLE, ""))


@contextmanager
def also_in(folder: Path) -> Iterator[None]:
    """Find interfaces in a folder as well, before others: those that an exercise brings with it."""
    before = os.environ.get(PATH_VARIABLE)
    if folder.is_dir():
        os.environ[PATH_VARIABLE] = path_with(str(folder.absolute()))
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(PATH_VARIABLE, None)
        else:
            os.environ[PATH_VARIABLE] = before


@lru_cache(maxsize=64)
def _fields_of(interface: str, folders: str) -> Mapping[str, Fields]:
    """The fields of an interface, which are other ones where other folders are searched."""
    del folders
    from course_kit.interfaces import InterfaceDefinitionError, InterfaceNotFoundError, text_of
    from course_kit.interfaces.parser import parse

    try:
        definition = parse(interface, text_of(interface))
    except (InterfaceNotFoundError, InterfaceDefinitionError) as problem:
        raise UnknownInterfaceError(str(problem)) from None
    parts = PARTS[interface.split("/")[1]]
    if parts == ("message",):
        return {"message": _fields(definition, interface)}  # type: ignore[arg-type] # of a message
    return {part: _fields(getattr(definition, part), f"the {part} of {interface}") for part in parts}


def _fields(message: MessageDefinition, name: str) -> Fields:
    return Fields(name, {one.name: one.type for one in message.fields})
