"""Ordinary mistakes: operators, numbers, texts and names in expressions; conditions, loops, returns and calls."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from course_kit.authoring.prove.program import Mutation, parse_expression
from course_kit.reader.python import called_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.authoring.prove.program import ParsedProgram

_ARITHMETIC: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.FloorDiv,
    ast.Pow: ast.Mult,
}
_EDGES: dict[type[ast.cmpop], type[ast.cmpop]] = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}
_OPPOSITES = ((ast.Lt, ast.GtE), (ast.Gt, ast.LtE), (ast.Eq, ast.NotEq), (ast.In, ast.NotIn), (ast.Is, ast.IsNot))
_REVERSED: dict[type[ast.cmpop], type[ast.cmpop]] = {**dict(_OPPOSITES), **{two: kind for kind, two in _OPPOSITES}}
_MIXED_UP = {"min": "max", "max": "min", "all": "any", "any": "all", "isfinite": "isnan", "isnan": "isinf"}
_SLIGHTLY = 1e-3  # of a number
_SYMMETRIC = {"dist", "min", "max", "hypot", "isclose"}
_SENTENCE = re.compile(r"[A-Za-z] [A-Za-z]")
_NO_OWNERS = ("self", "rclpy", "math", "threading", "time", "node", "executor")  # of what a mistake would mix up
_OTHER_FIELDS = 2  # of the same thing, that are taken for the right one


def change_operators(program: ParsedProgram) -> Iterator[Mutation]:
    """Another operator, an operand forgotten."""
    for node in program.nodes():
        if isinstance(node, ast.BinOp):
            if other := _ARITHMETIC.get(type(node.op)):
                yield Mutation("another operator", node, ast.BinOp(node.left, other(), node.right))
            yield Mutation("operand forgotten", node, node.left)
            yield Mutation("operand forgotten", node, node.right)
        elif isinstance(node, ast.UnaryOp) and not isinstance(node.operand, ast.Constant):
            yield Mutation("sign or not forgotten", node, node.operand)
        elif isinstance(node, ast.BoolOp):
            other_one = ast.Or() if isinstance(node.op, ast.And) else ast.And()
            yield Mutation("and for or", node, ast.BoolOp(other_one, node.values))
            yield from (Mutation("condition forgotten", part, None) for part in node.values)


def change_comparisons(program: ParsedProgram) -> Iterator[Mutation]:
    """An edge that belongs to the other side, a comparison turned round, one half of a range forgotten."""
    for node in program.nodes():
        if not isinstance(node, ast.Compare):
            continue
        for place, operator in enumerate(node.ops):
            for name, table in (("edge", _EDGES), ("comparison reversed", _REVERSED)):
                if other := table.get(type(operator)):
                    ops = [*node.ops[:place], other(), *node.ops[place + 1 :]]
                    yield Mutation(name, node, ast.Compare(node.left, ops, node.comparators))
        if len(node.ops) > 1:
            shorter = ast.Compare(node.left, node.ops[:-1], node.comparators[:-1])
            yield Mutation("condition forgotten", node, shorter)
            rest = ast.Compare(node.comparators[0], node.ops[1:], node.comparators[1:])
            yield Mutation("condition forgotten", node, rest)


def change_numbers(program: ParsedProgram) -> Iterator[Mutation]:
    """Another number: one more, one less, 0, the other sign, slightly off. One with a sign is changed as a whole."""
    for node in program.nodes():
        value = _number(node)
        if value is None or _number(program.parent(node)) is not None:
            continue
        others = [("another number", value + 1), ("another number", value - 1)]
        others += [("another sign", -value), ("zero", type(value)(0))]
        if isinstance(value, float):
            others += [("number slightly off", float(f"{value * by:.9g}")) for by in (1 + _SLIGHTLY, 1 - _SLIGHTLY)]
        for name, other in others:
            if other != value:  # -0.0
                yield Mutation(name, node, parse_expression(repr(round(other, 9))))


def _number(node: ast.AST) -> int | float | None:
    """The number that stands there, with its sign, or None."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = _number(node.operand)
        return None if value is None else -value
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
        return node.value
    return None


def change_texts(program: ParsedProgram) -> Iterator[Mutation]:
    """Another text, or none; True for False."""
    for node in program.nodes():
        if isinstance(node, ast.JoinedStr):
            yield from _mutate_formatted_text(node)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            if not _SENTENCE.search(node.value):  # its words are free
                yield Mutation("another text", node, ast.Constant(f"{node.value}_x"))
            yield Mutation("empty text", node, ast.Constant(""))
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            yield Mutation("true for false", node, ast.Constant(not node.value))


def _mutate_formatted_text(node: ast.JoinedStr) -> Iterator[Mutation]:
    """A formatted text: its words changed one by one, its values left out."""
    yield Mutation("empty text", node, ast.Constant(""))
    if any(isinstance(part, ast.Constant) and _SENTENCE.search(str(part.value)) for part in node.values):
        return  # its words are free
    for part in node.values:
        if isinstance(part, ast.Constant):
            yield Mutation("another text", part, ast.Constant(f"{part.value!s}_"), at=node)
        elif len(node.values) > 1:
            yield Mutation("value left out of a text", part, None, at=node)


def change_elements(program: ParsedProgram) -> Iterator[Mutation]:
    """An element left out of a list; another answer taken from the same place elsewhere."""
    for node in program.nodes():
        if isinstance(program.parent(node), ast.ExceptHandler) and "KeyboardInterrupt" in ast.dump(node):
            continue  # how a program ends on Ctrl-C is nobody's business
        if isinstance(node, (ast.Tuple, ast.List)) and isinstance(node.ctx, ast.Load) and len(node.elts) > 1:
            yield from (Mutation("element left out", item, None) for item in node.elts)
        elif isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                if key is not None:
                    yield Mutation("entry left out", key, None, also=(value, None))
            yield from _other_answers(node)


def _other_answers(node: ast.Dict) -> Iterator[Mutation]:
    """For each part of an entry that is a tuple, what stands in its place in other entries."""
    tuples = [part for part in node.values if isinstance(part, ast.Tuple)]
    for entry in tuples:
        for column, part in enumerate(entry.elts):
            known = {ast.unparse(pair.elts[column]): None for pair in tuples if len(pair.elts) > column}
            for other in [text for text in known if text != ast.unparse(part)][:_OTHER_FIELDS]:
                yield Mutation("another answer", part, parse_expression(other))


def change_names(program: ParsedProgram) -> Iterator[Mutation]:
    """Names that are easily mixed up: fields of the same thing, min and max, two arguments."""
    used = _fields(program)
    for node in program.nodes():
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, (ast.Load, ast.Store)):
            if node.attr in _MIXED_UP:
                yield Mutation("another function", node, ast.Attribute(node.value, _MIXED_UP[node.attr]))
            others = [name for name in used.get(_attribute_owner(program, node), ()) if name != node.attr]
            for other in others[:_OTHER_FIELDS]:
                yield Mutation("another field", node, ast.Attribute(node.value, other, node.ctx))
        elif isinstance(node, ast.Name) and node.id in _MIXED_UP:
            yield Mutation("another function", node, ast.Name(_MIXED_UP[node.id]))
        elif isinstance(node, ast.Call) and len(node.args) > 1 and called_name(node) not in _SYMMETRIC:
            swapped = [node.args[1], node.args[0], *node.args[2:]]
            yield Mutation("arguments swapped", node, ast.Call(node.func, swapped, node.keywords))


def _attribute_owner(program: ParsedProgram, node: ast.Attribute) -> tuple[ast.AST | None, str]:
    return program.function(node), ast.unparse(node.value)


def _fields(program: ParsedProgram) -> dict[tuple[ast.AST | None, str], dict[str, None]]:
    """The fields that each function uses of each thing; a vector has all three."""
    found: dict[tuple[ast.AST | None, str], dict[str, None]] = {}
    for node in ast.walk(program.tree):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) not in _NO_OWNERS:
            fields = found.setdefault(_attribute_owner(program, node), {})
            fields[node.attr] = None
            if node.attr in ("x", "y", "z"):
                fields |= dict.fromkeys("xyz")
            elif node.attr in ("linear", "angular"):
                fields |= dict.fromkeys(("linear", "angular"))
    return found


def change_conditions(program: ParsedProgram) -> Iterator[Mutation]:
    """A condition negated, always or never true; a branch left out; a loop that is run once."""
    for node in program.nodes():
        if isinstance(node, (ast.If, ast.While, ast.IfExp)) and node.test not in program.out_of_sight:
            test = node.test
            if not (isinstance(test, ast.Compare) and len(test.ops) == 1) and not isinstance(test, ast.UnaryOp):
                yield Mutation("condition negated", test, ast.UnaryOp(ast.Not(), test))
            yield Mutation("condition always true", test, ast.Constant(value=True))
            yield Mutation("condition never true", test, ast.Constant(value=False))
        if isinstance(node, ast.If) and node.orelse and node.test not in program.out_of_sight:
            yield Mutation("branch left out", node, ast.If(node.test, [ast.Pass()], node.orelse), at=node.body[0])
            if not isinstance(node.orelse[0], ast.If):
                yield Mutation("branch left out", node, ast.If(node.test, node.body, [ast.Pass()]), at=node.orelse[0])
        elif isinstance(node, (ast.For, ast.While)):
            yield Mutation("loop run once", node.body[-1], [node.body[-1], ast.Break()], at=node)


def change_jumps(program: ParsedProgram) -> Iterator[Mutation]:
    """A call or an assignment left out, a return without its value, or none at all."""
    for node in program.nodes():
        if isinstance(node, ast.Expr) and isinstance(node.value, (ast.Call, ast.Await)):
            if not program.is_unseen_call(node.value):
                yield Mutation("call left out", node, ast.Pass())
        elif isinstance(node, (ast.Assign, ast.AugAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if any(_can_be_seen(target, node.value) for target in targets):
                yield Mutation("assignment left out", node, ast.Pass())
        elif isinstance(node, ast.Return) and node.value is not None:
            yield Mutation("return left out", node, ast.Expr(node.value))
            for other in ("None", *_default_return_type(program, node)):
                yield Mutation("another value returned", node.value, parse_expression(other))
        elif isinstance(node, ast.Return):
            yield Mutation("return left out", node, ast.Pass())
        elif isinstance(node, (ast.Raise, ast.Break, ast.Continue)):
            yield Mutation("jump left out", node, ast.Pass())


def _can_be_seen(target: ast.expr, value: ast.expr) -> bool:
    """Whether somebody can see that an assignment is missing: a message's field has its default without it."""
    of_self = isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and target.value.id == "self"
    return isinstance(target, ast.Subscript) or (
        isinstance(target, ast.Attribute) and (of_self or not _is_default(value))
    )


def _is_default(value: ast.expr) -> bool:
    return isinstance(value, ast.Constant) and not value.value


def _default_return_type(program: ParsedProgram, node: ast.Return) -> Iterator[str]:
    """The type that a function says it returns, as ROS 2 makes it: with nothing filled in."""
    function = program.function(node)
    returned = function.returns if function else None
    quoted = isinstance(returned, ast.Constant) and isinstance(returned.value, str)
    name = str(returned.value) if quoted else ast.unparse(returned) if returned else ""  # type: ignore[union-attr]
    if name.endswith((".Result", ".Response")):
        yield f"{name}()"


def change_arguments(program: ParsedProgram) -> Iterator[Mutation]:
    """A call with an argument or a keyword less, or only its argument."""
    for call in (node for node in program.nodes() if isinstance(node, ast.Call)):
        of_a_message = called_name(call)[:1].isupper()
        for keyword in call.keywords:
            if not (of_a_message and _is_default(keyword.value)):
                yield Mutation("keyword left out", keyword, None)
        if len(call.args) > 1:
            yield Mutation("argument left out", call.args[-1], None)
        elif len(call.args) == 1 and not call.keywords and not isinstance(program.parent(call), ast.Expr):
            yield Mutation("function left out", call, call.args[0])


MISTAKES = (
    change_operators,
    change_comparisons,
    change_numbers,
    change_texts,
    change_elements,
    change_names,
    change_conditions,
    change_jumps,
    change_arguments,
)
