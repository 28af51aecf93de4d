"""In which style a right program is written, as far as its text shows."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_DEFINITIONS = (ast.Import, ast.ImportFrom, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef, ast.Assign)
_SEVERAL = 2


def wanted(solution: str) -> list[str]:
    """The styles that learners solve an exercise in; descriptors only where there are parameters to describe."""
    always = ["main", "class only", "async callbacks", "reentrant group", "several executors"]
    return always + (["descriptors"] if "declare_parameter" in solution else [])


def of(text: str) -> set[str]:
    """The styles of a program."""
    return set(_found(ast.parse(text)))


def _found(tree: ast.Module) -> Iterator[str]:
    nodes = list(ast.walk(tree))
    names = {node.id for node in nodes if isinstance(node, ast.Name)}
    names |= {node.attr for node in nodes if isinstance(node, ast.Attribute)}
    executors = [node for node in nodes if isinstance(node, ast.Call) and _called(node).endswith("Executor")]
    if any(isinstance(node, ast.FunctionDef) and node.name == "main" for node in tree.body):
        yield "main"
    if all(isinstance(node, _DEFINITIONS) or _is_docstring(node) for node in tree.body):
        yield "class only"
    if any(isinstance(node, ast.AsyncFunctionDef) for node in nodes):
        yield "async callbacks"
    if "ReentrantCallbackGroup" in names:
        yield "reentrant group"
    if len(executors) >= _SEVERAL:
        yield "several executors"
    if "ParameterDescriptor" in names:
        yield "descriptors"


def _called(call: ast.Call) -> str:
    return getattr(call.func, "id", getattr(call.func, "attr", ""))


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
