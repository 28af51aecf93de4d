"""Answers as a submission has set them: written out in its text, or handed over by a program that was run for them.

Either way they come as texts, in the words of `repr`, and are read as literals, never run. What is too long to be the
answer of a person is not read at all.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.quiz import Unusable

if TYPE_CHECKING:
    from course_kit.grading.plain_data import Record

_NO_LITERAL = (ValueError, TypeError, SyntaxError, RecursionError, MemoryError)
_LONGEST = 500  # characters of an answer or its id, as text


@dataclass(frozen=True)
class FoundAnswers:
    """What a submission has put into its variable.

    Attributes:
        entries: by id, each a value or `Unusable`; None when it is no dictionary.
        value: its text, when it is no dictionary.
        set_names: what else the program has set.
        is_set: whether there is such a variable at all.
        too_large: whether it was too much to be handed over.
    """

    entries: dict[object, object] | None = None
    value: str = ""
    set_names: tuple[str, ...] = field(default=())
    is_set: bool = True
    too_large: bool = False


def found(told: Record, variable: str) -> FoundAnswers:
    """The answers, as they are told.

    Args:
        told: of a program's text by `course_kit.reader.literals`, of one that was run by
            `course_kit.grading.sandbox.values`.
        variable: the name they are assigned to.
    """
    names = tuple(name for name in told.get("set_names", ()) if name != variable)
    if told.get("too_large"):
        return FoundAnswers(set_names=names, too_large=True)
    if "value" in told:
        return FoundAnswers(value=told["value"], set_names=names)
    if "entries" not in told:
        return FoundAnswers(set_names=names, is_set=False)
    entries: dict[object, object] = {}
    for key, text, *problem in told["entries"]:
        _put(entries, key, text, "".join(problem))
    return FoundAnswers(entries, set_names=names)


def _put(entries: dict[object, object], key: str, text: str, problem: str) -> None:
    try:
        value = Unusable(text, problem) if problem else _literal(text)
    except _NO_LITERAL:
        value = Unusable(text, "An answer has to be plain texts, but this is something else.")
    try:
        entries[_literal(key)] = value
    except _NO_LITERAL:
        entries[key] = value


def _literal(text: str) -> object:
    if len(text) > _LONGEST:
        raise ValueError("the answer is too long to be read")
    return ast.literal_eval(text)
