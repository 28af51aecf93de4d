"""Plain data, as JSON and TOML have it, read into objects with types: in one way, its errors worded once."""

from __future__ import annotations

from typing import Any, TypeAlias, TypeVar

import msgspec

Record: TypeAlias = dict[str, Any]
"""A JSON object: whoever reads it knows what is in it, and checks what a stranger may have written."""
T = TypeVar("T")
_MISSING = "Object missing required field "
_UNKNOWN = "Object contains unknown field "


def convert_record(record: object, kind: type[T]) -> T:
    """The object of a class whose fields a record has; ValueError says which of them is wrong."""
    try:
        return msgspec.convert(record, kind)
    except msgspec.ValidationError as problem:
        raise ValueError(_describe_mistake(str(problem))) from None


def _describe_mistake(said: str) -> str:
    what, _, place = said.replace("`", "").replace("$.", "").partition(" - at ")
    if what.startswith(_MISSING):
        return f"'{what.removeprefix(_MISSING)}' is missing{f' in {place}' if place else ''}"
    if what.startswith(_UNKNOWN):
        return f"there is no setting '{what.removeprefix(_UNKNOWN)}'{f' in {place}' if place else ''}"
    return f"'{place}' cannot be right: {what[:1].lower()}{what[1:]}"
