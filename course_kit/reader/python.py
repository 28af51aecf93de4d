"""What Python's own parser makes of a program: where it stops, and what the text gives away for a diagnosis."""

from __future__ import annotations

import ast
import resource
from bisect import bisect_left
from itertools import accumulate

from course_kit.reader.limits import MEMORY_MB

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

_LONGEST = 200  # characters of a line, or of what Python says about it
_MOST_FUNCTIONS = 1000
_CALLS, _LOOKS = frozenset({"call_async", "send_goal_async"}), frozenset({"done", "result", "wait"})
# Calls that wait for something that may never come, or make what is waited for.
_WAITING = frozenset({"Future", "acquire", "call", "input", "sleep", "spin_until_future_complete", "wait"})


class TooMuchError(ValueError):
    """Parsing it needs more than it may have; the text says so, and what to do."""


def parse(source: str) -> tuple[tuple[int, str, str] | None, ast.Module | None]:
    """Parse a program."""
    try:
        return None, ast.parse(source)
    except SyntaxError as fault:
        return (fault.lineno or 0, _cut((fault.text or "").strip()), _cut(fault.msg)), None
    except MemoryError as problem:  # of the machine's memory, or of the parser's own stack
        if resource.getrusage(resource.RUSAGE_SELF).ru_maxrss > MEMORY_MB * 1024 // 4:
            raise TooMuchError(
                f"Python needs more than {MEMORY_MB} MB of memory for it. Hand in a shorter, simpler program."
            ) from None
        return (0, "", f"Python cannot read it ({str(problem) or 'it is nested too deeply'})"), None
    except (ValueError, RecursionError) as problem:
        return (0, "", f"Python cannot read it ({_cut(str(problem))})"), None


def facts(tree: ast.Module) -> dict[str, object]:
    """What a program's text gives away, as `Facts` has it."""
    told = {"awaits": False, "floor_divides": False, "loops": False, "waits": False}
    spans: list[tuple[int, int]] = []
    calls, looks = [], []  # lines in which a call is sent and not waited for; in which a future is looked at
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            if node.attr in _CALLS:
                calls.append(node.lineno)
            elif node.attr in _LOOKS:
                looks.append(node.lineno)
        elif isinstance(node, ast.Await):
            told["awaits"] = True
        elif isinstance(node, (ast.BinOp, ast.AugAssign)):
            told["floor_divides"] |= isinstance(node.op, ast.FloorDiv)
        elif isinstance(node, ast.While):
            told["loops"] = True
        elif isinstance(node, ast.Call):
            told["waits"] |= _called(node) in _WAITING
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            spans.append((node.lineno, node.end_lineno or node.lineno))
    return {**told, "functions": _functions(spans, sorted(calls), sorted(looks)), "future": _first_future(tree)}


def starts(source: str) -> list[tuple[int, int]]:
    """Where a program starts itself: the slices of lines of `if __name__ == "__main__":` and of a bare `main()`."""
    try:
        _, tree = parse(source)
    except TooMuchError:
        return []  # whoever reads it as a program says so
    return [(one.lineno - 1, one.end_lineno or one.lineno) for one in (tree.body if tree else ()) if _is_start(one)]


def _is_start(statement: ast.stmt) -> bool:
    if isinstance(statement, ast.If):
        test = statement.test
        sides = [test.left, *test.comparators] if isinstance(test, ast.Compare) else []
        return any(isinstance(side, ast.Name) and side.id == "__name__" for side in sides)
    called = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(called, ast.Call) and isinstance(called.func, ast.Name) and called.func.id == "main"


def defined_twice(tree: ast.Module, sizes: Sequence[int]) -> str:
    """A class, else `main`, that more than one cell of a notebook defines; empty where there is none."""
    ends = list(accumulate(sizes))
    cells: dict[str, set[int]] = {}
    for one in tree.body:
        if isinstance(one, ast.ClassDef) or (isinstance(one, ast.FunctionDef) and one.name == "main"):
            cells.setdefault(one.name, set()).add(bisect_left(ends, one.lineno))
    found = [_cut(name) for name, where in cells.items() if len(where) > 1]
    return min(found, key=lambda name: name == "main", default="")


def _first_future(tree: ast.Module) -> int:
    """The first line in which a Future is made; 0 when there is none."""
    calls = (node for node in ast.walk(tree) if isinstance(node, ast.Call))
    return min((call.lineno for call in calls if _called(call) == "Future"), default=0)


def _called(call: ast.Call) -> str:
    """The last name of what is called; empty where it has none."""
    return str(getattr(call.func, "attr", getattr(call.func, "id", "")))


def _functions(
    spans: Sequence[tuple[int, int]], calls: Sequence[int], looks: Sequence[int]
) -> list[tuple[int, int, bool]]:
    """First and last line of each function, and whether it sends a call and looks at a future; none if none does."""
    found = [
        (first, last, _any_between(calls, first, last) and _any_between(looks, first, last)) for first, last in spans
    ]
    return found[:_MOST_FUNCTIONS] if any(waits for _, _, waits in found) else []


def _any_between(lines: Sequence[int], first: int, last: int) -> bool:
    place = bisect_left(lines, first)
    return place < len(lines) and lines[place] <= last


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
