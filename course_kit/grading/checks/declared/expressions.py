"""Expressions in exercise.toml, such as "request.a + request.b": read and worked out by walking their syntax tree.

Nothing is ever handed to Python's `eval`. Values are plain data (numbers, texts, lists, and dicts for messages), so
an attribute is a look-up in a dict, and there is no object whose attributes could be reached. What is written is small,
and what it works out stays small: there are no loops, and no number or text grows without bound.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.declared.evaluation import (
    ARITHMETIC,
    CONSTANTS,
    EQUALS,
    FUNCTIONS,
    OF_ANYTHING,
    ORDERS,
    ExpressionError,
    value_of,
)
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

_LONGEST = 500  # characters
_MOST_NODES = 200
_DEEPEST = 40


@dataclass(frozen=True)
class Expression:
    """One expression.

    Attributes:
        text: as it is written.
        tree: its syntax.
    """

    text: str
    tree: ast.expr

    @classmethod
    @lru_cache(maxsize=1024)  # a check works out the same ones for each of its inputs
    def parse(cls, text: str) -> Expression:
        """Read an expression.

        Raises:
            ExpressionError: it is too long, no expression, or has a part that these expressions do not have.
        """
        if len(text) > _LONGEST:
            raise ExpressionError(f"it is longer than {_LONGEST} characters")
        try:
            tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError) as problem:
            told = problem.msg if isinstance(problem, SyntaxError) else "it is nested too deeply"
            raise ExpressionError(f"it is no expression ({told})") from None
        _require_small(tree)
        _require_known_parts(tree)
        return cls(text.strip(), tree)

    def paths(self) -> list[tuple[str, ...]]:
        """The names it looks up, each with the fields after it, `("request", "a")`; without its constants."""
        found: list[tuple[str, ...]] = []
        waiting: list[ast.AST] = [self.tree]
        while waiting:
            node = waiting.pop(0)
            path = _path(node)
            if path is not None:
                if path[0] not in CONSTANTS:
                    found.append(path)
                continue
            waiting += [
                child for child in ast.iter_child_nodes(node) if not (isinstance(node, ast.Call) and child is node.func)
            ]
        return found

    def value(self, names: Mapping[str, Any]) -> Any:
        """What it works out to.

        Args:
            names: plain data by name.

        Raises:
            ExpressionError: it has no value for these, such as a division by zero.
        """
        try:
            return value_of(self.tree, names)
        except ExpressionError as problem:
            raise ExpressionError(f'"{self.text}" has no value: {problem}') from None
        except (ArithmeticError, ValueError, TypeError, LookupError) as problem:
            raise ExpressionError(f'"{self.text}" has no value: {problem}') from None


def _require_small(tree: ast.expr) -> None:
    level: list[ast.AST] = [tree]
    count = depth = 0
    while level:
        count, depth = count + len(level), depth + 1
        if count > _MOST_NODES or depth > _DEEPEST:
            raise ExpressionError("it has too many parts; write it shorter, or write this check in Python")
        level = [child for node in level for child in ast.iter_child_nodes(node)]


def _require_known_parts(tree: ast.expr) -> None:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            _require_known_function(node)
        elif isinstance(node, ast.Attribute) and node.attr.startswith("_"):
            raise ExpressionError(f"there is no field '{node.attr}'")
        elif isinstance(node, ast.Constant) and not isinstance(node.value, (bool, int, float, str)):
            raise ExpressionError(f"{node.value!r} is no number, text or truth value")
        elif not isinstance(node, _PARTS):
            raise ExpressionError(f"it has a part that is not allowed here ({type(node).__name__})")


def _require_known_function(node: ast.Call) -> None:
    known = [*FUNCTIONS, *OF_ANYTHING]
    if not isinstance(node.func, ast.Name):
        raise ExpressionError("only the functions of these expressions can be called")
    if node.func.id not in known:
        near = did_you_mean(node.func.id, known)
        raise ExpressionError(f"there is no function {node.func.id}().{near} There are {', '.join(sorted(known))}")
    if node.keywords:
        raise ExpressionError(f"{node.func.id}() takes no arguments by name")


_PARTS = (
    ast.Attribute,
    ast.BinOp,
    ast.BoolOp,
    ast.Compare,
    ast.Constant,
    ast.IfExp,
    ast.List,
    ast.Name,
    ast.Subscript,
    ast.Tuple,
    ast.UnaryOp,
    ast.Load,
    ast.And,
    ast.Or,
    ast.Not,
    ast.UAdd,
    ast.USub,
    *EQUALS,
    *ORDERS,
    *ARITHMETIC,
)


def _path(node: ast.AST) -> tuple[str, ...] | None:
    """`request.target.x` as its names, and `parameters["max.speed"]`; None for anything else."""
    if isinstance(node, ast.Name):
        return (node.id,)
    if isinstance(node, ast.Attribute):
        before = _path(node.value)
        return None if before is None else (*before, node.attr)
    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, str):
        before = _path(node.value)
        return None if before is None else (*before, node.slice.value)
    return None
