"""A program as text and as a tree, and changes to it that leave all else as it was written."""

from __future__ import annotations

import ast
import textwrap
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

Function = ast.FunctionDef | ast.AsyncFunctionDef
_WHOLE = (ast.Constant, ast.Name, ast.Attribute, ast.Call, ast.Tuple, ast.List, ast.JoinedStr)  # never in parentheses
_AT_THE_END, _IN_MAIN = ("destroy_node", "shutdown", "try_shutdown"), ("main", "spin")
# Calls that are handed a callback, by how the callback's keyword is called where it is given by name.
_TAKE_CALLBACKS = ("create_", "add_", "ActionServer", "ActionClient", "Timer")


@dataclass(frozen=True, order=True)
class Edit:
    """A part of the text, by its offsets, and what replaces it."""

    start: int
    end: int
    text: str


@dataclass(frozen=True)
class Mutation:
    """One mistake: what kind, on which line, from 1, and what it replaces."""

    operator: str
    line: int
    edits: tuple[Edit, ...]


@dataclass
class ParsedProgram:
    """A program that can be parsed."""

    source: str  # its text, with plain line ends
    # whether it has to start its node; else a grader starts the class, and nobody sees its `main`
    starts_itself: bool = True
    tree: ast.Module = field(init=False)

    def __post_init__(self) -> None:
        """Parse it."""
        self.tree = ast.parse(self.source)

    @cached_property
    def lines(self) -> list[str]:
        """Its lines, without their ends."""
        return self.source.split("\n")

    @cached_property
    def parents(self) -> dict[ast.AST, ast.AST]:
        """The node around each node."""
        return {child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)}

    @cached_property
    def _starts(self) -> list[int]:
        starts = [0]
        for line in self.lines:
            starts.append(starts[-1] + len(line) + 1)
        return starts

    def offset(self, line: int, column: int) -> int:
        """Where a position of the tree stands in the text; `column` counts bytes, as the tree does."""
        before = self.lines[line - 1].encode()[:column].decode()
        return self._starts[line - 1] + len(before)

    def span(self, node: ast.AST) -> tuple[int, int]:
        """Where a node begins and ends in the text."""
        found = [getattr(node, name) for name in ("lineno", "col_offset", "end_lineno", "end_col_offset")]
        return self.offset(found[0], found[1]), self.offset(found[2], found[3])

    def text(self, node: ast.AST) -> str:
        """A node as it is written."""
        start, end = self.span(node)
        return self.source[start:end]

    def statement_text(self, statement: ast.stmt) -> str:
        """A statement as it is written, its further lines moved to the left as far as the first one."""
        first, *more = self.text(statement).split("\n")
        indent = self.indent(statement)
        return "\n".join([first, *(line.removeprefix(indent) for line in more)])

    def indent(self, node: ast.AST) -> str:
        """What stands before the first statement on the line where a statement begins."""
        line = self.lines[_line(node) - 1]
        return line[: len(line) - len(line.lstrip())]

    def around(self, node: ast.AST) -> Iterator[ast.AST]:
        """The nodes around a node, the nearest first."""
        while (above := self.parents.get(node)) is not None:
            yield above
            node = above

    def function(self, node: ast.AST) -> Function | None:
        """The function that a node stands in."""
        return next(
            (one for one in self.around(node) if isinstance(one, (ast.FunctionDef, ast.AsyncFunctionDef))), None
        )

    @cached_property
    def methods(self) -> dict[str, Function]:
        """The methods of all classes, by name."""
        classes = [node for node in ast.walk(self.tree) if isinstance(node, ast.ClassDef)]
        inside = [one for each in classes for one in each.body]
        return {one.name: one for one in inside if isinstance(one, (ast.FunctionDef, ast.AsyncFunctionDef))}

    @cached_property
    def functions(self) -> dict[str, Function]:
        """All functions that are no methods, by name."""
        found = [node for node in ast.walk(self.tree) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
        return {one.name: one for one in found if not isinstance(self.parents[one], ast.ClassDef)}

    @cached_property
    def callback_references(self) -> list[ast.Attribute | ast.Name]:
        """Where a function is handed over to be called later: `self.convert` in `create_service(...)`."""
        found: list[ast.Attribute | ast.Name] = []
        for call in self.calls():
            if self.name_of(call).startswith(_TAKE_CALLBACKS):
                values = [*call.args, *(keyword.value for keyword in call.keywords)]
                found += [
                    one for one in values if isinstance(one, ast.Attribute | ast.Name) and self._called_later(one)
                ]
        return found

    def _called_later(self, reference: ast.Attribute | ast.Name) -> Function | None:
        """The function that a callback's name stands for."""
        if isinstance(reference, ast.Name):
            return self.functions.get(reference.id)
        of_self = isinstance(reference.value, ast.Name) and reference.value.id == "self"
        return self.methods.get(reference.attr) if of_self else None

    @cached_property
    def callbacks(self) -> list[Function]:
        """The functions that ROS calls."""
        found = [self._called_later(one) for one in self.callback_references]
        return list(dict.fromkeys(one for one in found if one is not None))

    def is_method(self, function: Function) -> bool:
        """Whether a function has a `self`."""
        return self.methods.get(function.name) is function

    def calls(self) -> Iterator[ast.Call]:
        """All calls."""
        return (node for node in ast.walk(self.tree) if isinstance(node, ast.Call))

    @staticmethod
    def name_of(call: ast.Call) -> str:
        """What a call calls, without what stands before it: `spin` of `rclpy.spin()`."""
        return str(getattr(call.func, "id", getattr(call.func, "attr", "")))

    def is_unseen_call(self, value: ast.expr) -> bool:
        """Whether nobody sees that a call is missing: at a program's end, or in a `main` that no grader needs."""
        name = self.name_of(value) if isinstance(value, ast.Call) else ""
        return name in _AT_THE_END or (name in _IN_MAIN and not self.starts_itself)

    @cached_property
    def out_of_sight(self) -> set[ast.AST]:
        """Nodes in which nothing can go wrong that is worth grading.

        Docstrings, annotations, the guard around `main()`, and what is only printed or logged.
        """
        found: set[ast.AST] = set()
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
                found.add(node)
            elif isinstance(node, ast.arg) and node.annotation:
                found.add(node.annotation)
            elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.returns:
                found.add(node.returns)
            elif isinstance(node, ast.AnnAssign):
                found.add(node.annotation)
            elif isinstance(node, ast.If) and "__name__" in ast.dump(node.test):
                found.add(node.test)
            elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call) and is_told(node.value):
                found.add(node)
        return {inside for node in found for inside in ast.walk(node)}

    def nodes(self) -> Iterator[ast.AST]:
        """The nodes that a mistake can be made in, in the order of the text."""
        inside_texts = {
            inside for node in ast.walk(self.tree) if isinstance(node, ast.JoinedStr) for inside in ast.walk(node)
        }  # before Python 3.12 they have no positions of their own
        found = [
            node
            for node in ast.walk(self.tree)
            if _line(node)
            and node not in self.out_of_sight
            and (node not in inside_texts or isinstance(node, ast.JoinedStr))
        ]
        yield from sorted(found, key=lambda node: (_line(node), int(getattr(node, "col_offset", 0))))

    def replace(self, node: ast.AST, text: str) -> Edit:
        """A node replaced; the further lines of `text` are set under the first one."""
        first, *more = text.split("\n")
        if more and isinstance(node, ast.stmt):
            indented = textwrap.indent("\n".join(more), self.indent(node))
            return Edit(*self.span(node), f"{first}\n{indented}")
        return Edit(*self.span(node), text)

    def swap(self, node: ast.expr, new: ast.expr) -> Edit:
        """An expression replaced, in parentheses only where it would be read in another way without them."""
        bare = ast.unparse(new)
        if isinstance(new, _WHOLE) or not isinstance(self.parents[node], ast.expr):
            return self.replace(node, bare)
        edits = [self.replace(node, bare), self.replace(node, f"({bare})")]
        trees = [parsed(self.apply([edit])) for edit in edits]
        return edits[0] if trees[0] == trees[1] else edits[1]

    def before(self, statement: ast.stmt, text: str) -> Edit:
        """Lines added before a statement."""
        start, _ = self.span(statement)
        lines = textwrap.indent(text, self.indent(statement)).lstrip()
        return Edit(start, start, f"{lines}\n{self.indent(statement)}")

    def after(self, statement: ast.stmt, text: str) -> Edit:
        """Lines added after a statement."""
        _, end = self.span(statement)
        return Edit(end, end, f"\n{textwrap.indent(text, self.indent(statement))}")

    def without(self, call: ast.Call, argument: ast.expr | ast.keyword) -> Edit:
        """An argument of a call taken out, with the comma that belongs to it."""
        given: list[ast.expr | ast.keyword] = [*call.args, *call.keywords]
        given.sort(key=lambda one: (one.lineno, one.col_offset))
        place = given.index(argument)
        start, end = self.span(argument)
        if place + 1 < len(given):
            end = self.span(given[place + 1])[0]
        elif place:
            start = self.span(given[place - 1])[1]
        return Edit(start, end, "")

    def with_keyword(self, call: ast.Call, text: str) -> Edit:
        """A keyword added to a call: `name=value`."""
        _, end = self.span(call)
        before = self.source[: end - 1].rstrip()
        start = len(before)
        return Edit(start, start, text if before.endswith("(") else f" {text}" if before.endswith(",") else f", {text}")

    def imported(self, module: str) -> tuple[Edit, ...]:
        """What makes a module known by its name, where the program has not imported it yet."""
        for node in self.tree.body:
            if isinstance(node, ast.Import) and any(alias.name == module and not alias.asname for alias in node.names):
                return ()
        first = next(
            node
            for node in self.tree.body
            if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
            and not (isinstance(node, ast.ImportFrom) and node.module == "__future__")
        )
        return (self.before(first, f"import {module}"),)

    def apply(self, edits: list[Edit] | tuple[Edit, ...]) -> str:
        """The text with some edits made."""
        text = self.source
        for edit in sorted(edits, reverse=True):
            text = text[: edit.start] + edit.text + text[edit.end :]
        return text


def parsed(text: str) -> str:
    """What the text means to Python, whatever its comments and parentheses; empty where it is not Python."""
    try:
        compile(text, "mutant", "exec", dont_inherit=True)
        return ast.unparse(ast.parse(text))
    except (SyntaxError, ValueError):
        return ""


def is_told(call: ast.Call) -> bool:
    """Whether a call only prints or logs."""
    function = call.func
    if isinstance(function, ast.Name):
        return function.id == "print"
    if not isinstance(function, ast.Attribute):
        return False
    logs = function.attr in ("debug", "info", "warning", "warn", "error", "fatal")
    return logs and "log" in ast.unparse(function.value)


def _line(node: ast.AST) -> int:
    return int(getattr(node, "lineno", 0))
