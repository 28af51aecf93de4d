"""What the text of a grader's .py file says about its checks, read without running it."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

_DECORATOR, _LIST = "check", "CHECKS"


@dataclass(frozen=True)
class CheckFacts:
    """What an exercise's parts have to agree about, of one check.

    Attributes:
        id: its name.
        points: what it is worth.
        depends_on: ids of checks.
        proves: ids of sentences.
        line: where it stands.
        path: in which file; None for the exercise.toml.
    """

    id: str
    points: float
    depends_on: tuple[str, ...]
    proves: tuple[str, ...]
    line: int
    path: Path | None = None


def facts_of(path: Path) -> list[CheckFacts] | None:
    """The checks of a file; None where its text alone does not tell, such as points that are worked out.

    Args:
        path: the file.
    """
    try:
        body = ast.parse(path.read_text(encoding="utf-8")).body
    except (OSError, ValueError, SyntaxError):
        return None  # whoever loads it says what is wrong with it
    found = {one.name: _facts(one, path) for one in body if isinstance(one, ast.FunctionDef)}
    listed = _listed(body)
    if listed is None or not all(found.get(name) for name in listed):
        return None
    return [facts for name in listed if (facts := found[name]) is not None]


def _listed(body: list[ast.stmt]) -> list[str] | None:
    for one in body:
        if isinstance(one, ast.Assign):
            target: ast.expr = one.targets[0]
        elif isinstance(one, ast.AnnAssign):
            target = one.target
        else:
            continue
        if isinstance(target, ast.Name) and target.id == _LIST and isinstance(one.value, (ast.Tuple, ast.List)):
            names = [name.id for name in one.value.elts if isinstance(name, ast.Name)]
            return names if len(names) == len(one.value.elts) else None
    return None


def _facts(function: ast.FunctionDef, path: Path) -> CheckFacts | None:
    for decorator in function.decorator_list:
        if isinstance(decorator, ast.Call) and isinstance(decorator.func, ast.Name) and decorator.func.id == _DECORATOR:
            try:
                given: dict[str, Any] = {
                    str(one.arg): ast.literal_eval(one.value) for one in decorator.keywords if one.arg != "deadline_s"
                }
                named = {key: tuple(given.get(key, ())) for key in ("depends_on", "proves")}
                return CheckFacts(function.name, float(given["points"]), **named, line=function.lineno, path=path)
            except (ValueError, KeyError, TypeError):
                return None
    return None
