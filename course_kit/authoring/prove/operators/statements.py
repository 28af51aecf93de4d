"""Mistakes with statements: conditions, branches, loops, returns, calls and their arguments."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from course_kit.authoring.prove.program import Mutation

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.authoring.prove.program import ParsedProgram


def conditions(program: ParsedProgram) -> Iterator[Mutation]:
    """A condition negated, always or never true; a branch left out; a loop that is run once."""
    for node in program.nodes():
        if not isinstance(node, (ast.If, ast.While, ast.IfExp)) or node.test in program.out_of_sight:
            continue
        test = node.test
        if not (isinstance(test, ast.Compare) and len(test.ops) == 1) and not isinstance(test, ast.UnaryOp):
            yield _expression(program, "condition negated", test, ast.UnaryOp(ast.Not(), test))
        yield _expression(program, "condition always true", test, ast.Constant(value=True))
        yield _expression(program, "condition never true", test, ast.Constant(value=False))
        if isinstance(node, ast.If) and node.orelse:
            yield from _left_out(program, "branch left out", node.body)
            if not (len(node.orelse) == 1 and isinstance(node.orelse[0], ast.If)):
                yield from _left_out(program, "branch left out", node.orelse)
    for node in program.nodes():
        if isinstance(node, (ast.For, ast.While)):
            yield Mutation("loop run once", node.lineno, (program.after(node.body[-1], "break"),))


def statements(program: ParsedProgram) -> Iterator[Mutation]:
    """A call or an assignment left out, a return without its value, or none at all."""
    for node in program.nodes():
        if isinstance(node, ast.Expr) and isinstance(node.value, (ast.Call, ast.Await)):
            if program.is_unseen_call(node.value):
                continue
            yield Mutation("call left out", node.lineno, (program.replace(node, "pass"),))
        elif isinstance(node, (ast.Assign, ast.AugAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if any(_can_be_seen(one, node.value) for one in targets):
                yield Mutation("assignment left out", node.lineno, (program.replace(node, "pass"),))
        elif isinstance(node, ast.Return) and node.value is not None:
            yield Mutation("return left out", node.lineno, (program.replace(node, program.text(node.value)),))
            yield Mutation("another value returned", node.value.lineno, (program.replace(node.value, "None"),))
            if empty := _empty(program, node):
                yield Mutation("another value returned", node.value.lineno, (program.replace(node.value, empty),))
        elif isinstance(node, ast.Return):
            yield Mutation("return left out", node.lineno, (program.replace(node, "pass"),))
        elif isinstance(node, (ast.Raise, ast.Break, ast.Continue)):
            yield Mutation("jump left out", node.lineno, (program.replace(node, "pass"),))


def arguments(program: ParsedProgram) -> Iterator[Mutation]:
    """A call with an argument or a keyword less, or only its argument."""
    for call in program.calls():
        if call in program.out_of_sight or not _has_place(program, call):
            continue
        of_a_message = program.name_of(call)[:1].isupper()
        for keyword in call.keywords:
            if of_a_message and _is_default(keyword.value):
                continue
            yield Mutation("keyword left out", keyword.value.lineno, (program.without(call, keyword),))
        if len(call.args) > 1:
            yield Mutation("argument left out", call.args[-1].lineno, (program.without(call, call.args[-1]),))
        elif len(call.args) == 1 and not call.keywords and not isinstance(program.parents[call], ast.Expr):
            yield _expression(program, "function left out", call, call.args[0])


def _can_be_seen(target: ast.expr, value: ast.expr) -> bool:
    """Whether somebody can see that an assignment is missing: a message's field has its default without it."""
    of_self = isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and target.value.id == "self"
    return isinstance(target, ast.Subscript) or (
        isinstance(target, ast.Attribute) and (of_self or not _is_default(value))
    )


def _is_default(value: ast.expr) -> bool:
    return isinstance(value, ast.Constant) and not value.value


def _expression(program: ParsedProgram, operator: str, node: ast.expr, new: ast.expr, line: int = 0) -> Mutation:
    return Mutation(operator, line or node.lineno, (program.swap(node, new),))


def _left_out(program: ParsedProgram, operator: str, body: list[ast.stmt]) -> Iterator[Mutation]:
    if all(isinstance(one, ast.Pass) for one in body):
        return
    edits = [program.replace(body[0], "pass"), *(program.replace(one, "pass") for one in body[1:])]
    yield Mutation(operator, body[0].lineno, tuple(edits))


def _empty(program: ParsedProgram, node: ast.Return) -> str:
    """The type that a function says it returns, as ROS 2 makes it: with nothing filled in."""
    function = program.function(node)
    returned = function.returns if function else None
    if isinstance(returned, ast.Constant) and isinstance(returned.value, str):
        name = returned.value
    else:
        name = ast.unparse(returned) if returned else ""
    return f"{name}()" if name.endswith((".Result", ".Response")) else ""


def _has_place(program: ParsedProgram, node: ast.AST) -> bool:
    return not any(isinstance(one, ast.JoinedStr) for one in program.around(node))
