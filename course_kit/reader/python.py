"""What Python's own parser makes of a program: where it stops, and what the text gives away for a diagnosis."""

from __future__ import annotations

import ast
import builtins
import json
import resource
from bisect import bisect_left, bisect_right
from itertools import accumulate

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

MEMORY_MB = 768  # 1 MiB of ordinary Python takes 120 MB, of the densest 700 MB, a notebook of 64 MiB up to 400 MB
_LONGEST = 200  # characters of a line, or of what Python says about it
_MOST_FUNCTIONS = 1000
_LONGEST_LITERAL = 48 * 1024  # characters of all together
_TOO_DEEP = (RecursionError, MemoryError)
_NO_LITERAL = (ValueError, TypeError, SyntaxError, *_TOO_DEEP)
_NO_PAIR = "An answer is a pair of two texts."
_CALLS, _LOOKS = frozenset({"call_async", "send_goal_async"}), frozenset({"done", "result", "wait"})
# Calls that wait for something that may never come, or make what is waited for.
_WAITING = frozenset({"Future", "acquire", "call", "input", "sleep", "spin_until_future_complete", "wait"})
_ROUNDING = frozenset({"ceil", "floor", "int", "round", "trunc"})


def parse_program(source: str) -> tuple[tuple[int, str, str] | None, ast.Module | None]:
    """Parse a program."""
    try:
        return None, ast.parse(source)
    except SyntaxError as fault:
        return (fault.lineno or 0, _cut((fault.text or "").strip()), _cut(fault.msg)), None
    except MemoryError as problem:  # of the machine's memory, or of the parser's own stack
        if resource.getrusage(resource.RUSAGE_SELF).ru_maxrss > MEMORY_MB * 1024 // 4:
            raise
        return (0, "", f"Python cannot read it ({str(problem) or 'it is nested too deeply'})"), None
    except (ValueError, RecursionError) as problem:
        return (0, "", f"Python cannot read it ({_cut(str(problem))})"), None


def read_facts(tree: ast.Module) -> dict[str, object]:
    """What a program's text gives away, as `Facts` has it."""
    nodes = list(ast.walk(tree))
    called = [(called_name(node), node.lineno) for node in nodes if isinstance(node, ast.Call)]
    read = sorted((node.lineno, node.attr) for node in nodes if isinstance(node, ast.Attribute))
    calls, looks = ([line for line, name in read if name in names] for names in (_CALLS, _LOOKS))
    functions = [node for node in nodes if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]
    spans = [(function.lineno, function.end_lineno or function.lineno) for function in functions]
    found = [(*span, _any_between(calls, *span) and _any_between(looks, *span)) for span in spans]
    return {
        "awaits": any(isinstance(node, ast.Await) for node in nodes),
        "floor_divides": any(isinstance(node, ast.FloorDiv) for node in nodes),
        "rounds": any(name in _ROUNDING for name, _ in called),
        "loops": any(isinstance(node, ast.While) for node in nodes),
        "waits": any(name in _WAITING for name, _ in called),
        "functions": found[:_MOST_FUNCTIONS] if any(waits for _, _, waits in found) else [],
        "future": min((line for name, line in called if name == "Future"), default=0),
    }


def find_starts(source: str) -> list[tuple[int, int]]:
    """Where a program starts itself: the slices of lines of `if __name__ == "__main__":` and of a bare `main()`."""
    _, tree = parse_program(source)
    body = tree.body if tree else ()
    return [(node.lineno - 1, node.end_lineno or node.lineno) for node in body if _is_start(node)]


def _is_start(statement: ast.stmt) -> bool:
    match statement:
        case ast.If(ast.Compare(left, comparators=others)):
            return any(isinstance(side, ast.Name) and side.id == "__name__" for side in (left, *others))
        case ast.Expr(ast.Call(ast.Name("main"))):
            return True
    return False


def defined_twice(tree: ast.Module, sizes: Sequence[int]) -> str:
    """A class, else `main`, that more than one cell of a notebook defines, or ""."""
    ends = list(accumulate(sizes))
    cells: dict[str, set[int]] = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef) or (isinstance(node, ast.FunctionDef) and node.name == "main"):
            cells.setdefault(node.name, set()).add(bisect_left(ends, node.lineno))
    found = [_cut(name) for name, where in cells.items() if len(where) > 1]
    return min(found, key=lambda name: name == "main", default="")


def called_name(call: ast.Call) -> str:
    """The last name of what is called: `spin` of `rclpy.spin()`; empty where it has none."""
    return str(getattr(call.func, "attr", getattr(call.func, "id", "")))


def _any_between(lines: Sequence[int], first: int, last: int) -> bool:
    return bisect_left(lines, first) < bisect_right(lines, last)


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def read_literal(tree: ast.Module, variable: str) -> dict[str, object] | None:
    """What a program sets a variable to, as texts in the words of `repr`; None when only running it would show."""
    used = sum(isinstance(node, ast.Name) and node.id == variable for node in ast.walk(tree))
    values = [value for node in tree.body if (value := _assigned_value(node, variable)) is not None]
    if used != 1 or len(values) != 1:
        return None
    try:
        if isinstance(values[0], ast.Dict):
            facts: dict[str, object] = {"entries": _entries(values[0], _bound_names(tree))}
        else:
            facts = {"value": repr(ast.literal_eval(values[0]))}
    except _NO_LITERAL:
        return None
    return facts if len(json.dumps(facts)) < _LONGEST_LITERAL else {"too_large": True}


def _assigned_value(node: ast.stmt, variable: str) -> ast.expr | None:
    """The right side of `variable = ...`, with or without an annotation."""
    match node:
        case ast.Assign([ast.Name(name)], value) | ast.AnnAssign(ast.Name(name), _, value) if name == variable:
            return value
    return None


def _entries(table: ast.Dict, bound: frozenset[str] | None) -> list[tuple[str, str, str]]:
    """Key, value and problem of each entry."""
    entries = []
    for key, value in zip(table.keys, table.values, strict=True):
        if key is None:
            raise ValueError("another dictionary is unpacked into this one")
        name = ast.literal_eval(key)
        hash(name)  # else the program would fail here
        entries.append((repr(name), *_value(value, bound)))
    return entries


def _value(node: ast.expr, bound: frozenset[str] | None) -> tuple[str, str]:
    """The text of a literal, and nothing; or of one with a name that is nowhere set, and what is wrong with it."""
    try:
        return repr(ast.literal_eval(node)), ""
    except _TOO_DEEP:
        return "", _NO_PAIR
    except (ValueError, TypeError):
        names = [inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)]
        unknown = [name for name in names if bound is not None and name not in bound]
        if not unknown:
            raise
        problem = f"Without quotes, Python reads {unknown[0]} as the name of a variable, and there is no such variable."
        return ast.unparse(node), problem


def _bound_names(tree: ast.Module) -> frozenset[str] | None:
    """The names that a program gives a meaning to as a value may have it; None when that is unknown."""
    names = set(dir(builtins))
    for node in ast.walk(tree):
        if isinstance(node, ast.alias):
            if node.name == "*":
                return None
            names.add(node.asname or node.name.partition(".")[0])
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)) or isinstance(getattr(node, "ctx", None), ast.Store):
            names.add(str(getattr(node, "id", getattr(node, "name", ""))))
    return frozenset(names)
