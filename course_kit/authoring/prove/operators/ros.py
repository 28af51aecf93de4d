"""Mistakes with ROS: callbacks, the status of a goal, feedback, spinning, parameters, callback groups."""

from __future__ import annotations

import ast
import textwrap
from typing import TYPE_CHECKING

from course_kit.authoring.prove.program import Mutation

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.authoring.prove.program import Function, ParsedProgram

_STATUS = ("succeed", "abort", "canceled")
_DECISIONS = {"ACCEPT": "REJECT", "REJECT": "ACCEPT"}
_BLOCKED_S = 3.0  # seconds; longer than anybody waits for an answer
_SELDOM = 10  # of as many feedback messages one
_MESSAGES = ("publish", "publish_feedback")


def callbacks(program: ParsedProgram) -> Iterator[Mutation]:
    """A callback that does nothing, or another one of the class."""
    for reference in program.callback_references:
        for nothing in ("lambda *given: None", "lambda *given: given[-1]"):
            yield Mutation("callback does nothing", reference.lineno, (program.replace(reference, nothing),))
        for other in program.callback_references:
            edit = program.replace(reference, program.text(other))
            yield Mutation("another callback", reference.lineno, (edit,))


def goal_status(program: ParsedProgram) -> Iterator[Mutation]:
    """Another end of a goal; a goal that is accepted for rejected."""
    for call in program.calls():
        name = program.name_of(call)
        if name in _STATUS and isinstance(call.func, ast.Attribute) and not call.args:
            for other in _STATUS:
                if other != name:
                    text = f"{program.text(call.func.value)}.{other}()"
                    yield Mutation("status of a goal", call.lineno, (program.replace(call, text),))
    for node in program.nodes():
        if isinstance(node, ast.Attribute) and node.attr in _DECISIONS:
            text = f"{program.text(node.value)}.{_DECISIONS[node.attr]}"
            yield Mutation("status of a goal", node.lineno, (program.replace(node, text),))


def messages(program: ParsedProgram) -> Iterator[Mutation]:
    """What is published twice, once in all, or seldom."""
    published = [call for call in program.calls() if program.name_of(call) in _MESSAGES]
    for number, call in enumerate(published, start=1):
        statement = program.parents[call]
        if not isinstance(statement, ast.Expr):
            continue
        text = program.statement_text(statement)
        yield Mutation("published twice", call.lineno, (program.after(statement, text),))
        name = f"published_{number}"
        owner = _owner(program, call)
        count = f"{owner}.{name} = getattr({owner}, {name!r}, -1) + 1"
        for operator, test in (
            ("published once", f"{owner}.{name} == 0"),
            ("published seldom", f"{owner}.{name} % {_SELDOM} == 0"),
        ):
            changed = f"{count}\nif {test}:\n{textwrap.indent(text, '    ')}"
            yield Mutation(operator, call.lineno, (program.replace(statement, changed),))


def failing(program: ParsedProgram) -> Iterator[Mutation]:
    """A callback that raises, at once or when it is called again; one that blocks."""
    time, rclpy = program.imported("time"), program.imported("rclpy")
    for function in program.callbacks:
        first = _first_statement(function)
        line = function.lineno
        yield Mutation("exception in a callback", line, (program.before(first, 'raise RuntimeError("a mistake")'),))
        owner = "self" if program.is_method(function) else function.name
        again = (
            f'if hasattr({owner}, "called_{function.name}"):\n    raise RuntimeError("a mistake")\n'
            f"{owner}.called_{function.name} = True"
        )
        yield Mutation("exception in a callback", line, (program.before(first, again),))
        sleep = program.before(first, f"time.sleep({_BLOCKED_S})")
        yield Mutation("blocking callback", line, (sleep, *time))
        if program.is_method(function):
            wait = "rclpy.spin_until_future_complete(self, rclpy.task.Future())"
            yield Mutation("waiting in a callback", line, (program.before(first, wait), *rclpy))


def spinning(program: ParsedProgram) -> Iterator[Mutation]:
    """One thread for several, one message in all, no spinning (a call left out tells that as well)."""
    for call in program.calls():
        name = program.name_of(call)
        if name == "MultiThreadedExecutor":
            text = "rclpy.executors.SingleThreadedExecutor()"
            yield Mutation("one thread", call.lineno, (program.replace(call, text), *program.imported("rclpy")))
        elif name == "spin" and isinstance(call.func, ast.Attribute) and not program.is_unseen_call(call):
            text = f"{program.text(call.func)}_once({', '.join(program.text(one) for one in call.args)})"
            yield Mutation("one spin", call.lineno, (program.replace(call, text),))


def parameter_types(program: ParsedProgram) -> Iterator[Mutation]:
    """A parameter that is declared with a value of another type: 1 for 1.0, a text for a number."""
    for call in program.calls():
        value = call.args[1] if program.name_of(call) == "declare_parameter" and len(call.args) > 1 else None
        if isinstance(value, ast.Constant) and isinstance(value.value, (bool, int, float)):
            others = [
                repr(str(value.value)),
                repr(float(value.value) if type(value.value) is int else int(value.value)),
            ]
            for other in others:
                yield Mutation("parameter's type", value.lineno, (program.replace(value, other),))


def parameters(program: ParsedProgram) -> Iterator[Mutation]:
    """A parameter that is read once, when the node is made."""
    made = program.methods.get("__init__")
    if made is None:
        return
    for call in program.calls():
        inside = program.function(call)
        if program.name_of(call) != "get_parameter" or inside in (None, made) or not call.args:
            continue
        whole = _value_of(program, call)
        name = call.args[0].value if isinstance(call.args[0], ast.Constant) else None
        if not isinstance(name, str):
            continue
        kept = f"self.read_once_{name.replace('.', '_')}"
        edits = (program.after(made.body[-1], f"{kept} = {program.text(whole)}"), program.replace(whole, kept))
        yield Mutation("parameter read once", call.lineno, edits)


def groups(program: ParsedProgram) -> Iterator[Mutation]:
    """Everything in one callback group that lets one in at a time, or the other kind of group."""
    other = {"ReentrantCallbackGroup": "MutuallyExclusiveCallbackGroup"}
    other |= {value: key for key, value in other.items()}
    for call in program.calls():
        if name := other.get(program.name_of(call)):
            text = f"rclpy.callback_groups.{name}()"
            yield Mutation("callback group", call.lineno, (program.replace(call, text), *program.imported("rclpy")))


def _owner(program: ParsedProgram, call: ast.Call) -> str:
    """What a count of messages is kept on: the goal for its feedback, else the node."""
    if program.name_of(call) == "publish_feedback" and isinstance(call.func, ast.Attribute):
        return program.text(call.func.value)
    return "self"


def _first_statement(function: Function) -> ast.stmt:
    """The first statement that does something."""
    first = function.body[0]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and len(function.body) > 1:
        return function.body[1]
    return first


def _value_of(program: ParsedProgram, call: ast.Call) -> ast.expr:
    """`self.get_parameter("x").value` around `self.get_parameter("x")`."""
    above = program.parents[call]
    if isinstance(above, ast.Attribute) and above.attr == "value":
        return above
    if isinstance(above, ast.Attribute) and above.attr == "get_parameter_value":
        return _outermost(program, above)
    return call


def _outermost(program: ParsedProgram, node: ast.expr) -> ast.expr:
    above = program.parents[node]
    while isinstance(above, (ast.Attribute, ast.Call)) and getattr(above, "func", node) is node:
        node, above = above, program.parents[above]
    return node
