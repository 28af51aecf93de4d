"""Answers out of a submission's text, without running it where that can be avoided.

Learners write a plain dictionary, which is read as a literal. Only a program that works its answers out is run, in the
sandbox; it hands over texts, which are read as literals in turn.
"""

from __future__ import annotations

import ast
import builtins
from dataclasses import dataclass, field
from typing import Any

from course_kit.quiz import Unusable

_TOO_DEEP = (RecursionError, MemoryError)
_NO_LITERAL = (ValueError, TypeError, SyntaxError, *_TOO_DEEP)


@dataclass(frozen=True)
class Found:
    """What a submission has put into its variable.

    Attributes:
        entries: by id, each a value or `Unusable`; None when it is no dictionary.
        value: its text, when it is no dictionary.
        set_names: what else the program has set.
        is_set: whether there is such a variable at all.
        too_large: whether it was too much to be handed over.
    """

    entries: dict[Any, Any] | None = None
    value: str = ""
    set_names: tuple[str, ...] = field(default=())
    is_set: bool = True
    too_large: bool = False


def written_out(source: str, variable: str) -> Found | None:
    """The answers in a program's text, or None when only running it can tell.

    Args:
        source: Python that can be parsed.
        variable: the name they are assigned to.
    """
    tree = ast.parse(source)
    used = [node for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id == variable]
    if not used:
        return None
    values = [value for node in tree.body if (value := _assigned(node, variable)) is not None]
    if len(used) != 1 or len(values) != 1:
        return None
    if isinstance(values[0], ast.Dict):
        return _entries(values[0], _bound(tree))
    try:
        return Found(value=repr(ast.literal_eval(values[0])))
    except _NO_LITERAL:
        return None


def handed_over(notes: dict[str, Any], variable: str) -> Found:
    """The answers of a program that was run, from its notes: see `course_kit.grading.values`."""
    names = tuple(name for name in notes.get("set_names", ()) if name != variable)
    if notes.get("too_large"):
        return Found(set_names=names, too_large=True)
    if "value" in notes:
        return Found(value=notes["value"], set_names=names)
    if "entries" not in notes:
        return Found(set_names=names, is_set=False)
    entries: dict[Any, Any] = {}
    for key, text in notes["entries"]:
        _put(entries, key, text)
    return Found(entries, set_names=names)


def _put(entries: dict[Any, Any], key: str, text: str) -> None:
    try:
        value = ast.literal_eval(text)
    except _NO_LITERAL:
        value = Unusable(text, "An answer consists of plain texts, and this is something else.")
    try:
        entries[ast.literal_eval(key)] = value
    except _NO_LITERAL:
        entries[key] = value


def _assigned(node: ast.stmt, variable: str) -> ast.expr | None:
    """The right side of `variable = ...`, with or without an annotation."""
    if isinstance(node, ast.Assign) and len(node.targets) == 1:
        target: ast.expr = node.targets[0]
    elif isinstance(node, ast.AnnAssign):
        target = node.target
    else:
        return None
    return node.value if isinstance(target, ast.Name) and target.id == variable else None


def _entries(table: ast.Dict, bound: frozenset[str] | None) -> Found | None:
    entries: dict[Any, Any] = {}
    for key, value in zip(table.keys, table.values, strict=True):
        try:
            name = ast.literal_eval(key) if key is not None else None
            entries[name] = _value(value, bound)
        except _NO_LITERAL:
            return None
        if key is None:
            return None
    return Found(entries)


def _value(node: ast.expr, bound: frozenset[str] | None) -> Any:
    """The value of a literal; `Unusable` for one with a name that is nowhere set.

    Raises:
        ValueError: running the program is the only way to find out.
    """
    try:
        return ast.literal_eval(node)
    except _TOO_DEEP:
        return Unusable("", "An answer is a pair of two texts.")
    except (ValueError, TypeError):
        names = [inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)]
        unknown = [name for name in names if bound is not None and name not in bound]
        if not unknown:
            raise
        problem = f"Without quotes, Python takes {unknown[0]} for the name of a variable, and there is none."
        return Unusable(ast.unparse(node), problem)


def _bound(tree: ast.Module) -> frozenset[str] | None:
    """All names the program gives a meaning to, built-in ones included; None when that cannot be told."""
    names = set(dir(builtins))
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            names.add(node.name)
        elif isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.alias):
            if node.name == "*":
                return None
            names.add((node.asname or node.name).partition(".")[0])
    return frozenset(names)
