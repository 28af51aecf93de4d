"""Runs a program for the value of one variable, inside the sandbox, and hands the value over as text.

For exercises that are answered with data instead of a node. Outside, the text is read as a literal and never run.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import CodeType, ModuleType

    from course_kit.grading.model.plain_data import Record

_LONGEST = 48 * 1024  # characters of all together; the grader keeps 64 kB of a program's notes
_LONGEST_NAME, _MOST_NAMES = 40, 50


def run(code: CodeType, module: ModuleType, variable: str, note: Callable[..., None]) -> None:
    """Run a program and note what it has set."""
    try:
        exec(code, module.__dict__)  # noqa: S102 - the learner's program, which is what this process is for
    except SystemExit:  # a program that ends itself has set what it wanted to set
        note(**describe(vars(module), variable), ended_itself=True)
        raise
    note(**describe(vars(module), variable))


def describe(names: Mapping[str, object], variable: str) -> Record:
    """What a program has set, as texts."""
    own = [str(name)[:_LONGEST_NAME] for name in names if not str(name).startswith("_")]
    told: Record = {"set_names": own[:_MOST_NAMES]}
    if variable not in names:
        return told
    value = names[variable]
    if isinstance(value, Mapping):
        told["entries"] = [[_text(key), _text(entry)] for key, entry in value.items()]
    else:
        told["value"] = _text(value)
    return told if len(json.dumps(told)) < _LONGEST else {"set_names": told["set_names"], "too_large": True}


def _text(value: object) -> str:
    """The value as a literal where it is one at heart: a named tuple is a tuple, a member of a text Enum a text."""
    try:
        if isinstance(value, str):
            return repr(str.__str__(value))
        if isinstance(value, (tuple, list)):
            return f"[{', '.join(_text(part) for part in value)}]"
        return repr(value)
    except Exception:  # noqa: BLE001 - a learner's class, a list within itself, a number with too many digits
        return f"<{type(value).__name__}>"
