"""Dataclasses as JSON carries them between the grader's processes, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

if TYPE_CHECKING:
    from collections.abc import Mapping

Record: TypeAlias = dict[str, Any]
"""A JSON object: whoever reads it knows what is in it, and checks what a stranger may have written."""
T = TypeVar("T")


def rebuilt(kind: type[T], record: Mapping[str, Any], **parts: type) -> T:
    """The object of which `dataclasses.asdict` has made a record; JSON has turned its tuples into lists."""
    fields = {name: _with_tuples(value) for name, value in record.items()}
    return kind(**{**fields, **{name: rebuilt(part, record[name]) for name, part in parts.items()}})


def _with_tuples(value: object) -> object:
    return tuple(map(_with_tuples, value)) if isinstance(value, list) else value
