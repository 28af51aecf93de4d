"""What an expression works out to, by walking its syntax tree; see `expressions`."""

from __future__ import annotations

import ast
import math
import operator
from typing import TYPE_CHECKING, Any

from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

_LARGEST_INTEGER = 2**64
_LARGEST_POWER = 64
_LONGEST_VALUE = 4096  # characters of a text, elements of a list
_MOST_DIGITS = 15  # to round to
EQUALS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.In: lambda one, many: one in many,
    ast.NotIn: lambda one, many: one not in many,
}
ORDERS: dict[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
ARITHMETIC: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
}


class ExpressionError(ValueError):
    """An expression that cannot be read, or that has no value; the text says why, without a full stop."""


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def _round(value: float, digits: int = 0) -> float:
    if not isinstance(digits, int) or abs(digits) > _MOST_DIGITS:
        raise ExpressionError(f"round() takes at most {_MOST_DIGITS} digits")
    return round(value, digits) if digits else round(value)


def _of_list_or_arguments(choose: Callable[..., Any]) -> Callable[..., Any]:
    def chosen(*values: Any) -> Any:
        given = values[0] if len(values) == 1 and isinstance(values[0], list) else values
        return choose(_numbers(given))

    return chosen


def _numbers(values: Sequence[Any]) -> Sequence[Any]:
    if not all(isinstance(value, (int, float)) for value in values):
        raise ExpressionError("a number is needed here")
    return values


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "abs": abs,
    "atan2": math.atan2,
    "ceil": math.ceil,
    "clamp": _clamp,
    "cos": math.cos,
    "floor": math.floor,
    "hypot": math.hypot,
    "isfinite": math.isfinite,
    "isnan": math.isnan,
    "max": _of_list_or_arguments(max),
    "min": _of_list_or_arguments(min),
    "round": _round,
    "sin": math.sin,
    "sqrt": math.sqrt,
    "sum": _of_list_or_arguments(sum),
}
OF_ANYTHING = {"len": len}
CONSTANTS = {"pi": math.pi, "inf": math.inf, "nan": math.nan, "true": True, "false": False}


def value_of(node: ast.expr, names: Mapping[str, Any]) -> Any:  # noqa: C901, PLR0911 - a table of the parts
    """The value of a part that `Expression.parse` has let through; `names` are plain data by name."""
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name):
        return names[node.id] if node.id in names else _constant(node.id, names)
    if isinstance(node, ast.Attribute):
        return _field(value_of(node.value, names), node.attr)
    if isinstance(node, ast.Subscript):
        return _element(value_of(node.value, names), value_of(node.slice, names))
    if isinstance(node, (ast.List, ast.Tuple)):
        return [value_of(one, names) for one in node.elts]
    if isinstance(node, ast.UnaryOp):
        return _unary(node.op, value_of(node.operand, names))
    if isinstance(node, ast.BinOp):
        return _arithmetic(type(node.op), value_of(node.left, names), value_of(node.right, names))
    if isinstance(node, ast.BoolOp):
        stop = isinstance(node.op, ast.Or)
        return next((stop for one in node.values if _truth(value_of(one, names)) is stop), not stop)
    if isinstance(node, ast.Compare):
        return _compare(node, names)
    if isinstance(node, ast.IfExp):
        return value_of(node.body if _truth(value_of(node.test, names)) else node.orelse, names)
    assert isinstance(node, ast.Call) and isinstance(node.func, ast.Name)  # noqa: S101, PT018 - as was required
    return _call(node.func.id, [value_of(one, names) for one in node.args])


def _constant(name: str, names: Mapping[str, Any]) -> Any:
    if name not in CONSTANTS:
        raise ExpressionError(f"there is no '{name}' here.{did_you_mean(name, names)} There are {', '.join(names)}")
    return CONSTANTS[name]


def _field(value: Any, name: str) -> Any:
    if not isinstance(value, dict):
        raise ExpressionError(f"a {type(value).__name__} has no field '{name}'")
    if name not in value:
        raise ExpressionError(f"there is no field '{name}'.{did_you_mean(name, value)}")
    return value[name]


def _element(value: Any, place: Any) -> Any:
    if isinstance(value, dict):
        return _field(value, str(place))
    if not isinstance(place, int) or not isinstance(value, (list, str)):
        raise ExpressionError("only a list has elements, and they have numbers")
    return value[place]


def _unary(kind: ast.unaryop, value: Any) -> Any:
    if isinstance(kind, ast.Not):
        return not _truth(value)
    (number,) = _numbers([value])
    return -number if isinstance(kind, ast.USub) else number


def _arithmetic(kind: type[ast.operator], one: Any, two: Any) -> Any:
    if kind is ast.Add and isinstance(one, str) and isinstance(two, str):
        return _bounded(one + two)
    if kind is ast.Add and isinstance(one, list) and isinstance(two, list):
        return _bounded(one + two)
    _numbers([one, two])
    if kind is ast.Pow and abs(two) > _LARGEST_POWER:
        raise ExpressionError(f"the power {two!r} is above {_LARGEST_POWER}")
    return _bounded(ARITHMETIC[kind](one, two))


def _bounded(value: Any) -> Any:
    if isinstance(value, complex):
        raise ExpressionError("it is no real number")
    if isinstance(value, int) and abs(value) > _LARGEST_INTEGER:
        raise ExpressionError("it is a whole number of more than 64 bits")
    if isinstance(value, (str, list)) and len(value) > _LONGEST_VALUE:
        raise ExpressionError(f"it is longer than {_LONGEST_VALUE}")
    return value


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ExpressionError(f"{value!r} is neither true nor false")
    return value


def _compare(node: ast.Compare, names: Mapping[str, Any]) -> bool:
    left = value_of(node.left, names)
    for kind, other in zip(node.ops, node.comparators, strict=True):
        right = value_of(other, names)
        if type(kind) in ORDERS:
            if not (isinstance(left, str) and isinstance(right, str)):
                _numbers([left, right])
            holds = ORDERS[type(kind)](left, right)
        else:
            holds = EQUALS[type(kind)](left, right)
        if not holds:
            return False
        left = right
    return True


def _call(name: str, values: list[Any]) -> Any:
    if name in OF_ANYTHING:
        return OF_ANYTHING[name](*values)
    if name not in ("min", "max", "sum"):
        _numbers(values)
    return _bounded(FUNCTIONS[name](*values))
