"""Plain copies of messages: small, bounded, and safe to keep or to send to another process.

A learner may change a message after sending it, and an image has megabytes; so what is recorded is a copy that
keeps the first few elements of anything long.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

ELEMENTS = 8  # of a sequence
CHARACTERS = 120  # of a string
FIELDS = 12  # of a message
DEPTH = 4  # of messages inside messages
_PLAIN = frozenset({int, float, bool, type(None)})


def snapshot(value: object) -> Any:
    """Copy a message into numbers, strings, lists and dicts.

    Returns:
        For a message a dict of its fields; for a sequence a list of at most `ELEMENTS` elements, followed by
        "+N more" when there are more; a shortened string for anything else.
    """
    return _copy(value, DEPTH)


def _copy(value: object, depth: int) -> Any:
    kind: Any = type(value)
    if kind in _PLAIN:
        return value
    if kind is str:
        return _shorten(value)  # type: ignore[arg-type]
    names = _field_names(kind)
    if names is not None:
        return _copy_message(value, names, depth)
    if isinstance(value, dict):
        return {str(name): _copy(part, depth - 1) for name, part in list(value.items())[:FIELDS]}
    return _copy_other(value, depth)


def _copy_message(message: object, names: tuple[str, ...], depth: int) -> dict[str, Any]:
    if depth == 0:
        return {"...": "..."}
    copied = {}
    for name in names[:FIELDS]:
        value = getattr(message, name)
        copied[name] = value if type(value) in _PLAIN else _copy(value, depth - 1)
    if len(names) > FIELDS:
        copied["..."] = f"+{len(names) - FIELDS} more"
    return copied


@lru_cache(maxsize=256)
def _field_names(kind: type) -> tuple[str, ...] | None:
    """The fields of a message class; None for any other class."""
    names = getattr(kind, "_fields_and_field_types", None)
    return None if names is None else tuple(names)


def _copy_other(value: object, depth: int) -> Any:
    if isinstance(value, str):
        return _shorten(value)
    if hasattr(value, "__len__") and hasattr(value, "__getitem__"):
        length = len(value)
        head = [_copy(_as_python(element), depth) for element in value[:ELEMENTS]]
        return [*head, f"+{length - ELEMENTS} more"] if length > ELEMENTS else head
    return _shorten(str(_as_python(value)))


def _as_python(element: object) -> object:
    """A numpy number as Python's own; ROS arrays of fixed size are numpy arrays."""
    item = getattr(element, "item", None)
    return item() if callable(item) else element


def _shorten(text: str) -> str:
    return text if len(text) <= CHARACTERS else text[: CHARACTERS - 3] + "..."
