"""Mistakes in expressions: operators, numbers, texts, edges, names that are mixed up."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from course_kit.authoring.prove.program import Edit, Mutation

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
_EDGES: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
}
_REVERSED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
_MIXED_UP = {"min": "max", "max": "min", "all": "any", "any": "all", "isfinite": "isnan", "isnan": "isinf"}
_SLIGHTLY = 1e-3  # of a number
_SYMMETRIC = {"dist", "min", "max", "hypot", "isclose"}
_SENTENCE = re.compile(r"[A-Za-z] [A-Za-z]")
_OTHER_FIELDS = 2  # of the same thing, that are taken for the right one


def operators(program: ParsedProgram) -> Iterator[Mutation]:
    """Another operator, an operand forgotten."""
    for node in program.nodes():
        if isinstance(node, ast.BinOp):
            other = _ARITHMETIC.get(type(node.op))
            if other is not None:
                yield _swapped(program, "another operator", node, ast.BinOp(node.left, other(), node.right))
            yield _swapped(program, "operand forgotten", node, node.left)
            yield _swapped(program, "operand forgotten", node, node.right)
        elif isinstance(node, ast.UnaryOp) and not isinstance(node.operand, ast.Constant):
            yield _swapped(program, "sign or not forgotten", node, node.operand)
        elif isinstance(node, ast.BoolOp):
            other_one = ast.Or() if isinstance(node.op, ast.And) else ast.And()
            yield _swapped(program, "and for or", node, ast.BoolOp(other_one, node.values))
            for place in range(len(node.values)):
                left = [*node.values[:place], *node.values[place + 1 :]]
                new = left[0] if len(left) == 1 else ast.BoolOp(node.op, left)
                yield _swapped(program, "condition forgotten", node, new)


def comparisons(program: ParsedProgram) -> Iterator[Mutation]:
    """An edge that belongs to the other side, a comparison turned round, one half of a range forgotten."""
    for node in program.nodes():
        if not isinstance(node, ast.Compare):
            continue
        for place, operator in enumerate(node.ops):
            for name, table in (("edge", _EDGES), ("comparison reversed", _REVERSED)):
                if other := table.get(type(operator)):
                    ops = [*node.ops[:place], other(), *node.ops[place + 1 :]]
                    yield _swapped(program, name, node, ast.Compare(node.left, ops, node.comparators))
        if len(node.ops) > 1:
            shorter = ast.Compare(node.left, node.ops[:-1], node.comparators[:-1])
            yield _swapped(program, "condition forgotten", node, shorter)
            rest = ast.Compare(node.comparators[0], node.ops[1:], node.comparators[1:])
            yield _swapped(program, "condition forgotten", node, rest)


def numbers(program: ParsedProgram) -> Iterator[Mutation]:
    """Another number: one more, one less, 0, the other sign, slightly off. One with a sign is changed as a whole."""
    for node in program.nodes():
        value = _number(node)
        if value is None or not isinstance(node, ast.expr) or _number(program.parents[node]) is not None:
            continue
        others = [("another number", value + 1), ("another number", value - 1)]
        others += [("another sign", -value), ("zero", type(value)(0))]
        if isinstance(value, float):
            others += [("number slightly off", float(f"{value * by:.9g}")) for by in (1 + _SLIGHTLY, 1 - _SLIGHTLY)]
        for name, other in others:
            if other == value:  # -0.0
                continue
            new = ast.parse(repr(round(other, 9)), mode="eval").body
            yield _swapped(program, name, node, new)


def _number(node: ast.AST) -> int | float | None:
    """The number that stands there, with its sign; None where there is none."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = _number(node.operand)
        return None if value is None else -value
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
        return node.value
    return None


def texts(program: ParsedProgram) -> Iterator[Mutation]:
    """Another text, or none; True for False."""
    for node in program.nodes():
        if isinstance(node, ast.JoinedStr):
            yield from _formatted(program, node)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            if not _SENTENCE.search(node.value):  # its words are free
                yield _swapped(program, "another text", node, ast.Constant(f"{node.value}_x"))
            if node.value:
                yield _swapped(program, "empty text", node, ast.Constant(""))
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            yield _swapped(program, "true for false", node, ast.Constant(not node.value))


def elements(program: ParsedProgram) -> Iterator[Mutation]:
    """An element left out of a list; another answer taken from the same place elsewhere."""
    for node in program.nodes():
        if isinstance(program.parents.get(node), ast.ExceptHandler) and "KeyboardInterrupt" in ast.dump(node):
            continue  # how a program ends on Ctrl-C is nobody's business
        if isinstance(node, (ast.Tuple, ast.List)) and isinstance(node.ctx, ast.Load):
            for place in range(len(node.elts) if len(node.elts) > 1 else 0):
                left = [*node.elts[:place], *node.elts[place + 1 :]]
                yield _swapped(program, "element left out", node, type(node)(left, node.ctx))
        elif isinstance(node, ast.Dict):
            for place, key in enumerate(node.keys):
                if key is not None:
                    yield from _entry(program, node, place)


def names(program: ParsedProgram) -> Iterator[Mutation]:
    """Names that are easily mixed up: fields of the same thing, min and max, two arguments."""
    used = _fields(program)
    for node in program.nodes():
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, (ast.Load, ast.Store)):
            if node.attr in _MIXED_UP:
                yield _swapped(program, "another function", node, ast.Attribute(node.value, _MIXED_UP[node.attr]))
            others = [one for one in used.get(_place(program, node), ()) if one != node.attr]
            for other in others[:_OTHER_FIELDS]:
                yield _swapped(program, "another field", node, ast.Attribute(node.value, other, node.ctx))
        elif isinstance(node, ast.Name) and node.id in _MIXED_UP:
            yield _swapped(program, "another function", node, ast.Name(_MIXED_UP[node.id]))
        elif isinstance(node, ast.Call) and _can_be_swapped(program, node):
            swapped = [node.args[1], node.args[0], *node.args[2:]]
            yield _swapped(program, "arguments swapped", node, ast.Call(node.func, swapped, node.keywords))


def _can_be_swapped(program: ParsedProgram, call: ast.Call) -> bool:
    plain = not any(isinstance(one, ast.Starred) for one in call.args)
    return plain and len(call.args) > 1 and program.name_of(call) not in _SYMMETRIC


def _swapped(program: ParsedProgram, operator: str, node: ast.expr, new: ast.expr) -> Mutation:
    return Mutation(operator, node.lineno, (program.swap(node, new),))


def _formatted(program: ParsedProgram, node: ast.JoinedStr) -> Iterator[Mutation]:
    """A formatted text: its words changed one by one, its values left out."""
    yield _swapped(program, "empty text", node, ast.Constant(""))
    if any(isinstance(part, ast.Constant) and _SENTENCE.search(str(part.value)) for part in node.values):
        return  # its words are free
    for place, part in enumerate(node.values):
        rest = [*node.values[:place], *node.values[place + 1 :]]
        if isinstance(part, ast.Constant):
            parts = [*node.values[:place], ast.Constant(f"{part.value!s}_"), *node.values[place + 1 :]]
            yield _swapped(program, "another text", node, ast.JoinedStr(parts))
        elif rest:
            yield _swapped(program, "value left out of a text", node, ast.JoinedStr(rest))
    values = [place for place, part in enumerate(node.values) if isinstance(part, ast.FormattedValue)]
    if len(values) > 1:
        parts = list(node.values)
        parts[values[0]], parts[values[1]] = parts[values[1]], parts[values[0]]
        yield _swapped(program, "arguments swapped", node, ast.JoinedStr(parts))


def _entry(program: ParsedProgram, node: ast.Dict, place: int) -> Iterator[Mutation]:
    """An entry of a dictionary left out, or with a value that another entry has in the same place."""
    key, value = node.keys[place], node.values[place]
    assert key is not None  # noqa: S101 - the caller has looked
    start, end = program.span(key)[0], program.span(value)[1]
    more = program.source[end:]
    end += len(more) - len(more.lstrip(", \n")) if more.lstrip().startswith(",") else 0
    yield Mutation("entry left out", key.lineno, (Edit(start, end, ""),))
    if not isinstance(value, ast.Tuple):
        return
    for column, part in enumerate(value.elts):
        others = _column(node, column)
        for other in [one for one in others if one != ast.unparse(part)][:_OTHER_FIELDS]:
            yield Mutation("another answer", part.lineno, (program.replace(part, other),))


def _column(node: ast.Dict, column: int) -> list[str]:
    values = [one for one in node.values if isinstance(one, ast.Tuple) and len(one.elts) > column]
    return list(dict.fromkeys(ast.unparse(one.elts[column]) for one in values))


def _place(program: ParsedProgram, node: ast.Attribute) -> tuple[ast.AST | None, str]:
    return program.function(node), ast.unparse(node.value)


def _fields(program: ParsedProgram) -> dict[tuple[ast.AST | None, str], dict[str, None]]:
    """The fields that each function uses of each thing; a vector has all three."""
    found: dict[tuple[ast.AST | None, str], dict[str, None]] = {}
    for node in ast.walk(program.tree):
        if isinstance(node, ast.Attribute) and not _is_module_or_self(node.value):
            place = found.setdefault(_place(program, node), {})
            place[node.attr] = None
            if node.attr in ("x", "y", "z"):
                place |= dict.fromkeys("xyz")
            elif node.attr in ("linear", "angular"):
                place |= dict.fromkeys(("linear", "angular"))
    return found


def _is_module_or_self(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id in ("self", "rclpy", "math", "threading", "time", "node", "executor")
