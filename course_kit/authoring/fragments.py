"""Pieces of a solution, such as the one method that an exercise asks for: put into the starter they can be graded."""

from __future__ import annotations

import ast
import re
import textwrap
from typing import TYPE_CHECKING, TypeGuard

from course_kit.authoring.programs import parsed

if TYPE_CHECKING:
    from collections.abc import Sequence

    Function = ast.FunctionDef | ast.AsyncFunctionDef
_IMPORTS = (ast.Import, ast.ImportFrom)


class Skeleton:
    """The starter of an exercise, as what pieces of a solution are put into.

    Attributes:
        imports: what the starter and the solution import, for a piece that comes without it.
    """

    def __init__(self, starter: str, solution: str = "") -> None:
        self._starter = starter
        tree = parsed(starter) or ast.Module([], [])
        solved = parsed(solution) or ast.Module([], [])
        found = [ast.unparse(node) for node in (*tree.body, *solved.body) if isinstance(node, _IMPORTS)]
        self.imports = "\n".join(dict.fromkeys(found))
        self._behind_imports = max(
            [node.end_lineno or 0 for node in tree.body if isinstance(node, _IMPORTS)], default=0
        )
        functions = [
            node for one in tree.body if isinstance(one, ast.ClassDef) for node in one.body if _is_function(node)
        ]
        self._methods = {node.name: _lines(node) for node in functions}
        own = "|".join(name for name in self._methods if not name.startswith("__"))  # every class has an __init__
        self._own = re.compile(rf"^[^\S\n]*(?:async )?def (?:{own})\(\s*self\b" if own else r"(?!)", re.MULTILINE)

    def may_take(self, text: str) -> bool:
        """Whether a text could hold one of its methods."""
        return self._own.search(text) is not None

    def completed(self, text: str, tree: ast.Module) -> str:
        """The starter with the methods of a piece in the place of its own; empty if the piece has none of them.

        Args:
            text: the piece.
            tree: its tree.
        """
        methods = [node for node in tree.body if _is_method(node)]
        if not any(node.name in self._methods and not node.name.startswith("__") for node in methods):
            return ""
        written = {node.name: _as_method(text.split("\n"), node) for node in methods}
        lines = self._starter.split("\n")
        last = max(end for _, end in self._methods.values())
        lines[last:last] = [
            line for name, block in written.items() if name not in self._methods for line in ("", *block)
        ]
        for name, (first, end) in sorted(self._methods.items(), key=lambda method: -method[1][0]):
            if name in written:
                lines[first - 1 : end] = written[name]
        others = [ast.unparse(node) for node in tree.body if not _is_method(node)]
        lines[self._behind_imports : self._behind_imports] = [*self.imports.split("\n"), *others]
        return "\n".join(lines)


def _is_function(node: ast.AST) -> TypeGuard[Function]:
    return isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))


def _is_method(node: ast.AST) -> TypeGuard[Function]:
    return _is_function(node) and [one.arg for one in node.args.args[:1]] == ["self"]


def _lines(node: Function) -> tuple[int, int]:
    """First and last line of a function, its decorators included."""
    return min([node.lineno, *(one.lineno for one in node.decorator_list)]), node.end_lineno or node.lineno


def _as_method(lines: Sequence[str], node: Function) -> list[str]:
    first, end = _lines(node)
    return textwrap.indent("\n".join(lines[first - 1 : end]), "    ").split("\n")
