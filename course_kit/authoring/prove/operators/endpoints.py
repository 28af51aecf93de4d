"""Mistakes with what a node has on the graph: names, types, QoS, endpoints that are gone again."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from course_kit.authoring.prove.program import Mutation

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.authoring.prove.program import ParsedProgram

_TYPED = {
    "create_service": "service",
    "create_client": "client",
    "create_publisher": "publisher",
    "create_subscription": "subscription",
    "ActionServer": "action server",
    "ActionClient": "action client",
}
_DESTROYED = {"service": "service", "publisher": "publisher", "subscription": "subscription", "timer": "timer"}
_QOS = "rclpy.qos.QoSProfile"
_TOPIC_QOS = (
    f"{_QOS}(depth=10, reliability=rclpy.qos.ReliabilityPolicy.BEST_EFFORT)",
    f"{_QOS}(depth=10, durability=rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL)",
    f"{_QOS}(depth=1)",
)
_SERVICE_QOS = _TOPIC_QOS[:2]
# Types with the same fields, or nearly so: what one takes who did not look closely.
_ALIKE = {
    "Float64": "Float32",
    "Float32": "Float64",
    "Int64": "Int32",
    "Int32": "Int64",
    "Bool": "Int8",
    "String": "Char",
    "Twist": "Accel",
    "Point": "Vector3",
    "Vector3": "Point",
    "Pose": "Transform",
    "SetBool": "Trigger",
    "Trigger": "Empty",
    "AddTwoInts": "Trigger",
    "Fibonacci": "LookupTransform",
}
_FALLBACK = {
    "create_service": "std_srvs.srv.Trigger",
    "create_publisher": "std_msgs.msg.String",
    "create_subscription": "std_msgs.msg.String",
    "ActionServer": "example_interfaces.action.Fibonacci",
}


def endpoint_names(program: ParsedProgram) -> Iterator[Mutation]:
    """Another name, and a private one; also of the node itself."""
    for call, kind in _endpoints(program):
        name = _name_argument(call, kind)
        if name is not None:
            written = str(name.value)
            for other in (f"{written}s", f"~/{written.lstrip('/')}"):
                yield Mutation("endpoint's name", name.lineno, (program.replace(name, repr(other)),))


def endpoint_types(program: ParsedProgram) -> Iterator[Mutation]:
    """A type that looks alike, imported under the name of the right one; for one endpoint, another type."""
    for node in program.nodes():
        if isinstance(node, ast.ImportFrom) and (node.module or "").endswith((".msg", ".srv", ".action")):
            for alias in node.names:
                if other := _ALIKE.get(alias.name):
                    known = alias.asname or alias.name
                    yield Mutation("type alike", node.lineno, (program.replace(alias, f"{other} as {known}"),))
    for call, _ in _endpoints(program):
        other = _FALLBACK.get(program.name_of(call), "")
        place = 1 if program.name_of(call).startswith("Action") else 0
        module, _, name = other.rpartition(".")
        if other and len(call.args) > place and program.text(call.args[place]) != name:
            imported = f'__import__("{module}", fromlist=["*"]).{name}'
            yield Mutation("another type", call.lineno, (program.replace(call.args[place], imported),))


def quality_of_service(program: ParsedProgram) -> Iterator[Mutation]:
    """Best effort, transient local, and a queue of one."""
    rclpy = program.imported("rclpy")
    for call, kind in _endpoints(program):
        if kind in ("publisher", "subscription"):
            place = 2 if kind == "publisher" else 3
            given = [keyword.value for keyword in call.keywords if keyword.arg == "qos_profile"]
            given += call.args[place : place + 1]
            for qos in _TOPIC_QOS if given else ():
                yield Mutation("quality of service", given[0].lineno, (program.replace(given[0], qos), *rclpy))
        elif kind == "service" and not any(keyword.arg == "qos_profile" for keyword in call.keywords):
            for qos in _SERVICE_QOS:
                edit = program.with_keyword(call, f"qos_profile={qos}")
                yield Mutation("quality of service", call.lineno, (edit, *rclpy))


def destroyed(program: ParsedProgram) -> Iterator[Mutation]:
    """An endpoint that is destroyed as soon as it is made."""
    for call in program.calls():
        kind = program.name_of(call).removeprefix("create_")
        if kind in _DESTROYED and isinstance(call.func, ast.Attribute):
            node = program.text(call.func.value)
            text = f"{node}.destroy_{kind}({program.text(call)})"
            yield Mutation("endpoint destroyed", call.lineno, (program.replace(call, text),))
        elif program.name_of(call) == "ActionServer":
            yield Mutation(
                "endpoint destroyed", call.lineno, (program.replace(call, f"{program.text(call)}.destroy()"),)
            )


def _endpoints(program: ParsedProgram) -> Iterator[tuple[ast.Call, str]]:
    for call in program.calls():
        kind = _TYPED.get(program.name_of(call))
        if kind is not None:
            yield call, kind


def _name_argument(call: ast.Call, kind: str) -> ast.Constant | None:
    place = 2 if kind.startswith("action") else 1
    given = call.args[place : place + 1]
    given += [keyword.value for keyword in call.keywords if keyword.arg in ("srv_name", "topic", "action_name")]
    return given[0] if given and isinstance(given[0], ast.Constant) and isinstance(given[0].value, str) else None
