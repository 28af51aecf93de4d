"""Mistakes with ROS: endpoints, callbacks, the status of a goal, feedback, spinning, parameters, callback groups."""

from __future__ import annotations

import ast
import textwrap
from typing import TYPE_CHECKING

from course_kit.authoring.prove.program import Mutation, parse_expression, parse_statements
from course_kit.reader.python import called_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.authoring.prove.program import Function, ParsedProgram

# By what makes an endpoint: where its name and its quality of service stand, and another type.
_ENDPOINTS = {
    "create_service": (1, None, "std_srvs.srv.Trigger"),
    "create_publisher": (1, 2, "std_msgs.msg.String"),
    "create_subscription": (1, 3, "std_msgs.msg.String"),
    "ActionServer": (2, None, "example_interfaces.action.Fibonacci"),
}
_NAMES, _QOS_NAME = ("srv_name", "topic", "action_name"), "qos_profile"
_QOS = "__import__('rclpy').qos"
_OTHER_QOS = (
    f"{_QOS}.QoSProfile(depth=10, reliability={_QOS}.ReliabilityPolicy.BEST_EFFORT)",
    f"{_QOS}.QoSProfile(depth=10, durability={_QOS}.DurabilityPolicy.TRANSIENT_LOCAL)",
    f"{_QOS}.QoSProfile(depth=1)",
)
_STATUS = ("succeed", "abort", "canceled")
_DECISIONS = {"ACCEPT": "REJECT", "REJECT": "ACCEPT"}
_BLOCKED_S = 3.0  # seconds; longer than anybody waits for an answer
_SELDOM = 10  # of as many feedback messages one
_MESSAGES = ("publish", "publish_feedback")
_GROUPS = "__import__('rclpy').callback_groups"
_OTHER_CALLS = {
    "MultiThreadedExecutor": ("one thread", "__import__('rclpy').executors.SingleThreadedExecutor()"),
    "ReentrantCallbackGroup": ("callback group", f"{_GROUPS}.MutuallyExclusiveCallbackGroup()"),
    "MutuallyExclusiveCallbackGroup": ("callback group", f"{_GROUPS}.ReentrantCallbackGroup()"),
}


def change_endpoints(program: ParsedProgram) -> Iterator[Mutation]:
    """Another name, and a private one; another type; best effort, transient local, and a queue of one."""
    for call in program.calls():
        if called_name(call) not in _ENDPOINTS:
            continue
        at_name, at_qos, other = _ENDPOINTS[called_name(call)]
        for name in _find_argument(call, at_name, *_NAMES):
            if isinstance(name, ast.Constant) and isinstance(name.value, str):
                for text in (f"{name.value}s", f"~/{name.value.lstrip('/')}"):
                    yield Mutation("endpoint's name", name, ast.Constant(text))
        if len(call.args) >= at_name and not other.endswith(f".{ast.unparse(call.args[at_name - 1])}"):
            module, _, kind = other.rpartition(".")
            new = parse_expression(f"__import__({module!r}, fromlist=['*']).{kind}")
            yield Mutation("another type", call.args[at_name - 1], new)
        given = _find_argument(call, at_qos, _QOS_NAME)
        for qos in map(parse_expression, _OTHER_QOS):
            if given:
                yield Mutation("quality of service", given[0], qos)
            elif called_name(call) == "create_service" and "depth=1)" not in ast.unparse(qos):
                more = [*call.keywords, ast.keyword(_QOS_NAME, qos)]
                yield Mutation("quality of service", call, ast.Call(call.func, call.args, more))


def _find_argument(call: ast.Call, place: int | None, *names: str) -> list[ast.expr]:
    """The argument of a call at a place or with one of these names."""
    found = [] if place is None else call.args[place : place + 1]
    return [*found, *(keyword.value for keyword in call.keywords if keyword.arg in names)]


def destroy_endpoints(program: ParsedProgram) -> Iterator[Mutation]:
    """An endpoint that is destroyed as soon as it is made."""
    for call in program.calls():
        kind = called_name(call).removeprefix("create_")
        if kind in ("service", "publisher", "subscription", "timer") and isinstance(call.func, ast.Attribute):
            new = ast.Call(ast.Attribute(call.func.value, f"destroy_{kind}"), [call], [])
            yield Mutation("endpoint destroyed", call, new)
        elif kind == "ActionServer":
            yield Mutation("endpoint destroyed", call, ast.Call(ast.Attribute(call, "destroy"), [], []))


def change_callbacks(program: ParsedProgram) -> Iterator[Mutation]:
    """A callback that does nothing, or another of the class; one that raises, blocks, or waits for itself."""
    for reference in program.callback_references:
        for nothing in ("lambda *given: None", "lambda *given: given[-1]"):
            yield Mutation("callback does nothing", reference, parse_expression(nothing))
        for other in program.callback_references:
            yield Mutation("another callback", reference, other)
    for function in dict.fromkeys(program.callback_references.values()):
        is_method = program.methods.get(function.name) is function
        flag = f"{'self' if is_method else function.name}.called_{function.name}"
        owner, _, name = flag.partition(".")
        added = [
            ("exception in a callback", "raise RuntimeError('a mistake')"),
            (
                "exception in a callback",
                f"if hasattr({owner}, {name!r}):\n    raise RuntimeError('a mistake')\n{flag} = True",
            ),
            ("blocking callback", f"__import__('time').sleep({_BLOCKED_S})"),
        ]
        if is_method:
            wait = "__import__('rclpy').spin_until_future_complete(self, __import__('rclpy').task.Future())"
            added.append(("waiting in a callback", wait))
        for operator, text in added:
            first = _first_statement(function)
            yield Mutation(operator, first, [*parse_statements(text), first], at=function)


def _first_statement(function: Function) -> ast.stmt:
    """The first statement that does something."""
    first = function.body[0]
    is_docstring = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
    return function.body[1] if is_docstring and len(function.body) > 1 else first


def change_goals(program: ParsedProgram) -> Iterator[Mutation]:
    """Another end of a goal; a goal that is accepted for rejected."""
    for call in program.calls():
        if called_name(call) in _STATUS and isinstance(call.func, ast.Attribute) and not call.args:
            for other in _STATUS:
                if other != called_name(call):
                    yield Mutation("status of a goal", call, ast.Call(ast.Attribute(call.func.value, other), [], []))
    for node in program.nodes():
        if isinstance(node, ast.Attribute) and node.attr in _DECISIONS:
            yield Mutation("status of a goal", node, ast.Attribute(node.value, _DECISIONS[node.attr]))


def change_messages(program: ParsedProgram) -> Iterator[Mutation]:
    """What is published twice, once in all, or seldom."""
    published = [call for call in program.calls() if called_name(call) in _MESSAGES]
    for number, call in enumerate(published, start=1):
        statement = program.parent(call)
        if not isinstance(statement, ast.Expr) or not isinstance(call.func, ast.Attribute):
            continue
        yield Mutation("published twice", statement, [statement, statement])
        # The count is kept on the goal for its feedback, else on the node.
        owner = ast.unparse(call.func.value) if called_name(call) == "publish_feedback" else "self"
        name = f"published_{number}"
        count = f"{owner}.{name} = getattr({owner}, {name!r}, -1) + 1"
        text = textwrap.indent(ast.unparse(statement), "    ")
        for operator, test in (("published once", "== 0"), ("published seldom", f"% {_SELDOM} == 0")):
            yield Mutation(operator, statement, parse_statements(f"{count}\nif {owner}.{name} {test}:\n{text}"))


def change_spinning(program: ParsedProgram) -> Iterator[Mutation]:
    """One thread for several, the other kind of callback group; one message in all."""
    for call in program.calls():
        if called_name(call) in _OTHER_CALLS:
            operator, text = _OTHER_CALLS[called_name(call)]
            yield Mutation(operator, call, parse_expression(text))
        elif called_name(call) == "spin" and isinstance(call.func, ast.Attribute) and not program.is_unseen_call(call):
            once = ast.Attribute(call.func.value, "spin_once")
            yield Mutation("one spin", call, ast.Call(once, call.args, call.keywords))


def change_parameters(program: ParsedProgram) -> Iterator[Mutation]:
    """A parameter that is declared with a value of another type, and one that is read once, when the node is made."""
    made = program.methods.get("__init__")
    for call in program.calls():
        if called_name(call) == "declare_parameter" and len(call.args) > 1 and isinstance(call.args[1], ast.Constant):
            value = call.args[1].value
            if isinstance(value, (bool, int, float)):
                for other in (str(value), float(value) if type(value) is int else int(value)):
                    yield Mutation("parameter's type", call.args[1], ast.Constant(other))
        elif called_name(call) == "get_parameter" and made and program.function(call) not in (None, made) and call.args:
            name = call.args[0].value if isinstance(call.args[0], ast.Constant) else None
            if isinstance(name, str):
                whole, last = _value_of(program, call), made.body[-1]
                attribute = f"self.read_once_{name.replace('.', '_')}"
                read = parse_statements(f"{attribute} = {ast.unparse(whole)}")
                yield Mutation("parameter read once", whole, parse_expression(attribute), also=(last, [last, *read]))


def _value_of(program: ParsedProgram, call: ast.Call) -> ast.expr:
    """`self.get_parameter("x").value` around `self.get_parameter("x")`, or what stands there for it."""
    node: ast.expr = call
    above = program.parent(node)
    while isinstance(above, ast.Attribute) or (isinstance(above, ast.Call) and above.func is node):
        node, above = above, program.parent(above)
    return node


MISTAKES = (
    change_endpoints,
    destroy_endpoints,
    change_callbacks,
    change_goals,
    change_messages,
    change_spinning,
    change_parameters,
)
