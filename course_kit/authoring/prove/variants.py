"""Right programs made from a solution: other executors, callback groups and orders, and a little slower."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.authoring.prove.changes import Edit
from course_kit.authoring.prove.program import ParsedProgram, parsed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.authoring.prove.program import Function

_SLOWER_S = 0.005  # seconds in each callback
_THREADS = (2, 8)  # of an executor with several
# Calls that take a group, and those whose callback may be a coroutine.
_GROUPED = ("create_service", "create_subscription", "create_timer", "ActionServer")
_AWAITED = ("create_service", "create_subscription", "create_timer", "ActionServer")
_MADE = ("create_service", "create_subscription", "create_publisher", "create_timer", "create_client", "ActionServer")


_NO_MAIN = "only the class, without main"


@dataclass(frozen=True)
class RightVariant:
    """A program that does what the solution does.

    Attributes:
        name: what is different.
        source: its text.
    """

    name: str
    source: str


def of(source: str, *, own_start: bool = False) -> list[RightVariant]:
    """The variants of a solution; those that come out as the solution itself are left out.

    Args:
        source: the solution's text.
        own_start: whether a program has to start its node itself, so that `main` belongs to it.

    Raises:
        SyntaxError: it is not Python.
    """
    program = ParsedProgram(source)
    seen = {parsed(source)}
    found = []
    for name, edits in _all(program):
        if name == _NO_MAIN and own_start:
            continue
        text = program.apply(tuple(edits))
        meaning = parsed(text)
        if edits and meaning and meaning not in seen:
            seen.add(meaning)
            found.append(RightVariant(name, text))
    return found


def _all(program: ParsedProgram) -> Iterator[tuple[str, Sequence[Edit]]]:
    yield from _executors(program)
    made: tuple[tuple[str, Callable[[ParsedProgram], Sequence[Edit]]], ...] = (
        (_NO_MAIN, _without_main),
        ("with a main", _with_main),
        ("reentrant callback groups", _reentrant),
        ("asynchronous callbacks", _asynchronous),
        ("endpoints made in another order", lambda one: _reversed(one, _MADE)),
        ("parameters declared in another order", lambda one: _reversed(one, ("declare_parameter",))),
        ("a little slower in each callback", _slower),
        ("entries in another order", _entries_reversed),
        ("made by a function", _by_function),
    )
    for name, make in made:
        yield name, make(program)


def _executors(program: ParsedProgram) -> Iterator[tuple[str, Sequence[Edit]]]:
    """Another executor where the solution spins on one thread; other numbers of threads where it has several."""
    rclpy = program.imported("rclpy")
    for call in program.calls():
        name = program.name_of(call)
        if name == "spin" and len(call.args) == 1 and not call.keywords:
            node = program.text(call.args[0])
            for executor in ("SingleThreadedExecutor()", "MultiThreadedExecutor(num_threads=4)"):
                text = f"{program.text(call.func)}({node}, rclpy.executors.{executor})"
                yield f"spins on a {executor}", (program.replace(call, text), *rclpy)
        elif name == "MultiThreadedExecutor":
            for threads in _THREADS:
                text = f"{program.text(call.func)}(num_threads={threads})"
                yield f"an executor with {threads} threads", (program.replace(call, text),)


def _without_main(program: ParsedProgram) -> Sequence[Edit]:
    guards = [node for node in program.tree.body if isinstance(node, ast.If) and "__name__" in ast.dump(node.test)]
    mains = [node for node in program.tree.body if isinstance(node, ast.FunctionDef) and node.name == "main"]
    return [program.replace(node, "") for node in (*guards, *mains)] if guards and mains else []


def _with_main(program: ParsedProgram) -> Sequence[Edit]:
    """A main where there is none, for a program with one class."""
    classes = [node for node in program.tree.body if isinstance(node, ast.ClassDef)]
    if len(classes) != 1 or any(isinstance(node, (ast.If, ast.FunctionDef)) for node in program.tree.body):
        return []
    end = len(program.source)
    text = (
        "\n\nimport rclpy\n\n\ndef main():\n    rclpy.init()\n"
        f"    rclpy.spin({classes[0].name}(), rclpy.executors.MultiThreadedExecutor(num_threads=4))\n\n\n"
        'if __name__ == "__main__":\n    main()\n'
    )
    return [Edit(end, end, text)]


def _reentrant(program: ParsedProgram) -> Sequence[Edit]:
    edits = [
        program.with_keyword(call, "callback_group=rclpy.callback_groups.ReentrantCallbackGroup()")
        for call in program.calls()
        if program.name_of(call) in _GROUPED and not any(one.arg == "callback_group" for one in call.keywords)
    ]
    return [*edits, *program.imported("rclpy")] if edits else []


def _asynchronous(program: ParsedProgram) -> Sequence[Edit]:
    """`async def` for each callback that nothing else in the program calls, and that rclpy awaits."""
    called = {program.name_of(call) for call in program.calls()}
    taken_otherwise = {
        program.text(one)
        for one in program.callback_references
        if not any(isinstance(above, ast.Call) and program.name_of(above) in _AWAITED for above in program.around(one))
    }
    return [
        Edit(program.span(one)[0], program.span(one)[0], "async ")
        for one in program.callbacks
        if isinstance(one, ast.FunctionDef)
        and one.name not in called
        and not {one.name, f"self.{one.name}"} & taken_otherwise
    ]


def _reversed(program: ParsedProgram, made: Sequence[str]) -> Sequence[Edit]:
    """Statements of `__init__` that follow each other, and each make one of these, in the opposite order."""
    edits: list[Edit] = []
    for function in (one for one in ast.walk(program.tree) if isinstance(one, ast.FunctionDef)):
        if function.name != "__init__":
            continue
        run: list[ast.stmt] = []
        for statement in [*function.body, None]:
            value = getattr(statement, "value", None)
            if isinstance(value, ast.Call) and program.name_of(value) in made and statement is not None:
                run.append(statement)
                continue
            edits += [program.replace(old, program.text(new)) for old, new in zip(run, run[::-1], strict=True)]
            run = []
    return edits


def _slower(program: ParsedProgram) -> Sequence[Edit]:
    edits = [program.before(_first(one), f"time.sleep({_SLOWER_S})") for one in program.callbacks]
    return [*edits, *program.imported("time")] if edits else []


def _entries_reversed(program: ParsedProgram) -> Sequence[Edit]:
    """The entries of a dictionary at the top of the program in the opposite order, if there is one and nothing else."""
    values = _only_dictionary(program)
    if values is None:
        return []
    pairs = zip(values.keys, values.values, strict=True)
    entries = [f"{program.text(key)}: {program.text(value)}" for key, value in pairs if key]
    return [program.replace(values, "{" + ", ".join(entries[::-1]) + "}")]


def _by_function(program: ParsedProgram) -> Sequence[Edit]:
    values = _only_dictionary(program)
    if values is None:
        return []
    statement = program.statement(values)
    made = f"def made():\n    return {program.text(values)}\n\n"
    return [program.replace(values, "made()"), program.before(statement, made)]


def _only_dictionary(program: ParsedProgram) -> ast.Dict | None:
    left = [node for node in program.tree.body if node not in program.out_of_sight]
    if len(left) == 1 and isinstance(left[0], ast.Assign) and isinstance(left[0].value, ast.Dict):
        return left[0].value
    return None


def _first(function: Function) -> ast.stmt:
    first = function.body[0]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and len(function.body) > 1:
        return function.body[1]
    return first
