"""A program as a tree in which a mistake can be made and taken back."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from course_kit.reader.python import called_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

Function = ast.FunctionDef | ast.AsyncFunctionDef
New = ast.expr | ast.stmt | list[ast.stmt] | None  # None stands for nothing
_AT_THE_END, _IN_MAIN = ("destroy_node", "shutdown", "try_shutdown"), ("main", "spin")
# Calls that are handed a callback.
_TAKE_CALLBACKS = ("create_", "add_", "ActionServer", "ActionClient", "Timer")
_LOGS = ("debug", "info", "warning", "warn", "error", "fatal")


@dataclass(frozen=True)
class Mutation:
    """One mistake: what kind, a node, and what stands there instead."""

    operator: str
    node: ast.AST
    new: New
    at: ast.AST | None = None  # where it is seen in the text, if that is another line
    also: tuple[ast.AST, New] | None = None  # a second place


class ParsedProgram:
    """A program that can be parsed; one that need not start its node is started by a grader, its `main` unseen."""

    def __init__(self, source: str, *, starts_itself: bool = True) -> None:
        self.tree = ast.parse(source)
        self.starts_itself = starts_itself

    @cached_property
    def _places(self) -> dict[ast.AST, tuple[ast.AST, str]]:
        """For each node the one around it, and in which of its fields it stands."""
        found: dict[ast.AST, tuple[ast.AST, str]] = {}
        for node in ast.walk(self.tree):
            for name, value in ast.iter_fields(node):
                inside = value if isinstance(value, list) else [value]
                found.update({child: (node, name) for child in inside if isinstance(child, ast.AST)})
        return found

    def parent(self, node: ast.AST) -> ast.AST:
        """The node around a node."""
        return self._places[node][0]

    def function(self, node: ast.AST) -> Function | None:
        """The function that a node stands in."""
        while node in self._places:
            node = self.parent(node)
            if isinstance(node, Function):
                return node
        return None

    @cached_property
    def methods(self) -> dict[str, Function]:
        """The methods of all classes, by name."""
        classes = [node for node in ast.walk(self.tree) if isinstance(node, ast.ClassDef)]
        return {node.name: node for each in classes for node in each.body if isinstance(node, Function)}

    @cached_property
    def callback_references(self) -> dict[ast.expr, Function]:
        """Where a function is handed over to be called later: `self.convert` in `create_service(...)`."""
        functions = {node.name: node for node in ast.walk(self.tree) if isinstance(node, Function)}
        found = {}
        for call in self.calls():
            values = [*call.args, *(keyword.value for keyword in call.keywords)]
            for value in values if called_name(call).startswith(_TAKE_CALLBACKS) else ():
                of_self = isinstance(value, ast.Attribute) and ast.unparse(value.value) == "self"
                known = self.methods if of_self else functions
                name = value.attr if isinstance(value, ast.Attribute) else getattr(value, "id", "")
                if name in known and (of_self or isinstance(value, ast.Name)):
                    found[value] = known[name]
        return found

    def calls(self) -> Iterator[ast.Call]:
        """All calls."""
        return (node for node in ast.walk(self.tree) if isinstance(node, ast.Call))

    def is_unseen_call(self, value: ast.expr) -> bool:
        """Whether nobody sees that a call is missing: at a program's end, or in a `main` that no grader needs."""
        name = called_name(value) if isinstance(value, ast.Call) else ""
        return name in _AT_THE_END or (name in _IN_MAIN and not self.starts_itself)

    @cached_property
    def out_of_sight(self) -> set[ast.AST]:
        """Nodes in which nothing can go wrong that is worth grading."""
        found: set[ast.AST | None] = set()
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Expr):
                only_said = isinstance(node.value, ast.Constant) or is_told(node.value)
                found.add(node if only_said else None)
            elif isinstance(node, (ast.arg, ast.AnnAssign)):
                found.add(node.annotation)
            elif isinstance(node, Function):
                found.add(node.returns)
            elif isinstance(node, ast.If) and "__name__" in ast.dump(node.test):
                found.add(node.test)
        return {inside for node in found if node is not None for inside in ast.walk(node)}

    def nodes(self) -> Iterator[ast.AST]:
        """The nodes that a mistake can be made in, in the order of the text."""
        inside_texts = {
            inside for text in ast.walk(self.tree) if isinstance(text, ast.JoinedStr) for inside in ast.walk(text)
        }
        found = [
            node
            for node in ast.walk(self.tree)
            if line_of(node)
            and node not in self.out_of_sight
            and (node not in inside_texts or isinstance(node, ast.JoinedStr))
        ]
        yield from sorted(found, key=lambda node: (line_of(node), int(getattr(node, "col_offset", 0))))

    def text_with(self, change: Mutation) -> str:
        """The program with a mistake, as `ast` writes it; empty where it is no Python then."""
        changes = [(change.node, change.new), *([change.also] if change.also else [])]
        before = []
        for node, new in changes:
            around, name = self._places[node]
            value = getattr(around, name)
            before.append((around, name, value))
            setattr(around, name, _replace_node(value, node, new) if isinstance(value, list) else new)
        text = ast.unparse(self.tree)
        for around, name, value in reversed(before):
            setattr(around, name, value)
        try:
            compile(text, "mutant", "exec", dont_inherit=True)
        except (SyntaxError, ValueError):
            return ""
        return text


def _replace_node(values: Sequence[ast.AST], node: ast.AST, new: New) -> list[ast.AST]:
    place = next(number for number, other in enumerate(values) if other is node)
    middle = new if isinstance(new, list) else [] if new is None else [new]
    return [*values[:place], *middle, *values[place + 1 :]]


def is_told(value: ast.expr) -> bool:
    """Whether a call only prints or logs."""
    if not isinstance(value, ast.Call):
        return False
    logs = isinstance(value.func, ast.Attribute) and value.func.attr in _LOGS and "log" in ast.unparse(value.func.value)
    return logs or ast.unparse(value.func) == "print"


def line_of(node: ast.AST) -> int:
    """The line on which a node begins; 0 for one that has none."""
    return int(getattr(node, "lineno", 0))


def parse_expression(text: str) -> ast.expr:
    """An expression, out of its text."""
    return ast.parse(text, mode="eval").body


def parse_statements(text: str) -> list[ast.stmt]:
    """Statements, out of their text."""
    return ast.parse(text).body
