"""What a program sets a variable to, where that can be told from its text, without running it.

Learners write a plain dictionary, which is read as a literal. It is told as texts, in the words of `repr`, as the
sandbox tells it of a program that has to be run for it (`course_kit.grading.sandbox.values`).
"""

from __future__ import annotations

import ast
import builtins
import json

_LONGEST = 48 * 1024  # characters of all together
_TOO_DEEP = (RecursionError, MemoryError)
_NO_LITERAL = (ValueError, TypeError, SyntaxError, *_TOO_DEEP)
_NO_PAIR = "An answer is a pair of two texts."


def written_out(tree: ast.Module, variable: str) -> dict[str, object] | None:
    """What a program sets a variable to; None when only running it can tell."""
    used = sum(isinstance(node, ast.Name) and node.id == variable for node in ast.walk(tree))
    values = [value for node in tree.body if (value := _assigned(node, variable)) is not None]
    if used != 1 or len(values) != 1:
        return None
    try:
        if isinstance(values[0], ast.Dict):
            told: dict[str, object] = {"entries": _entries(values[0], _bound(tree))}
        else:
            told = {"value": _text(ast.literal_eval(values[0]))}
    except _NO_LITERAL:
        return None
    return told if len(json.dumps(told)) < _LONGEST else {"too_large": True}


def _assigned(node: ast.stmt, variable: str) -> ast.expr | None:
    """The right side of `variable = ...`, with or without an annotation."""
    if isinstance(node, ast.Assign) and len(node.targets) == 1:
        target: ast.expr = node.targets[0]
    elif isinstance(node, ast.AnnAssign):
        target = node.target
    else:
        return None
    return node.value if isinstance(target, ast.Name) and target.id == variable else None


def _entries(table: ast.Dict, bound: frozenset[str] | None) -> list[tuple[str, str, str]]:
    """Key, value and problem of each entry."""
    entries = []
    for key, value in zip(table.keys, table.values, strict=True):
        if key is None:
            raise ValueError("another dictionary is unpacked into this one")
        name = ast.literal_eval(key)
        hash(name)  # else the program would fail here
        entries.append((_text(name), *_value(value, bound)))
    return entries


def _value(node: ast.expr, bound: frozenset[str] | None) -> tuple[str, str]:
    """The text of a literal, and nothing; or of one with a name that is nowhere set, and what is wrong with it."""
    try:
        return _text(ast.literal_eval(node)), ""
    except _TOO_DEEP:
        return "", _NO_PAIR
    except (ValueError, TypeError):
        names = [inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)]
        unknown = [name for name in names if bound is not None and name not in bound]
        if not unknown:
            raise
        problem = (
            f"Without quotes, Python takes {unknown[0]} for the name of a variable, and there is no such variable."
        )
        return ast.unparse(node), problem


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


def _text(value: object) -> str:
    try:
        return repr(value)
    except ValueError:  # a number with more digits than Python writes out
        return f"<{type(value).__name__}>"
