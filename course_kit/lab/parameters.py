"""Parameters of any node on the graph, over its parameter services, as `ros2 param` does it.

Each verb is written once, as a generator of questions (see `course_kit.ros.parameters`), and driven by asyncio in a
notebook and by a wait in a program.
"""

from __future__ import annotations

import asyncio
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from course_kit.lab.api import call, call_blocking, current
from course_kit.lab.awaiting import to_be_awaited
from course_kit.lab.errors import (
    FieldError,
    LabError,
    NodeNotFoundError,
    ParameterNotFoundError,
    ServiceNotFoundError,
)
from course_kit.ros import graph, names, parameters
from course_kit.ros.messages import BadFieldError
from course_kit.ros.parameters import Question

if TYPE_CHECKING:
    from rcl_interfaces.msg import Parameter, ParameterDescriptor
    from rclpy.node import Node

    from course_kit.lab.topics import DeliveryWait
    from course_kit.ros.parameters import Steps

T = TypeVar("T")
_TIMEOUT = 5.0  # seconds for each answer


@to_be_awaited("lab.get_parameters")
async def get_parameters(node: str | Node, /, *names: str, timeout: float = _TIMEOUT) -> Values:
    """Values of a node's parameters: `await lab.get_parameters("/parameter_node", "max_velocity")`.

    Args:
        node: the node's name, or a node of this lab.
        names: which ones; all of them without any, those that every node has last.
        timeout: seconds in which each answer must come.

    Returns:
        a dict that prints one parameter a line; None for a parameter that has no value.

    Raises:
        NodeNotFoundError: no such node has parameters.
        ParameterNotFoundError: the node has not declared one of the names.
        NoAnswerError: nothing came back in time.
    """
    name = full_name(node)
    return await _ask(name, _ask_for_values(name, names), timeout)


def get_parameters_blocking(node: str | Node, /, *names: str, timeout: float = _TIMEOUT) -> Values:
    """See `get_parameters`; this is the same for programs and for threads without an event loop."""
    name = full_name(node)
    return _ask_blocking(name, _ask_for_values(name, names), timeout)


@to_be_awaited("lab.set_parameters")
async def set_parameters(
    node: str | Node, given: dict[str, object] | None = None, /, *, atomically: bool = False, **values: object
) -> Outcome:
    """Set parameters of a node: `await lab.set_parameters("/parameter_node", max_velocity=2.0)`.

    A refusal is not an error but an outcome: the node decides, and says why. An undeclared name is refused, too.
    Returns when this lab's own subscriptions to /parameter_events have heard of it (1 s at most).

    Args:
        node: the node's name, or a node of this lab.
        given: values by name, for names that are no keywords: `{"wheel.diameter": 0.1}`.
        atomically: all of them or none; otherwise each by itself.
        values: values by name. 1 is an integer, 1.0 a double; a parameter keeps its type.

    Returns:
        the outcome, which prints as what was set or refused and why; `.successful` and `.reasons` say it to programs.

    Raises:
        NodeNotFoundError: no such node has parameters.
        FieldError: no parameter can have such a value.
        ServiceFailedError: a callback of a node in this lab raised.
        NoAnswerError: nothing came back in time.
    """
    name = full_name(node)
    with _wait_for_events() as waiting:
        outcome = await _ask(name, _ask_to_set(name, {**(given or {}), **values}, atomically=atomically), _TIMEOUT)
        await asyncio.to_thread(waiting.wait, outcome.events)
    return outcome


def set_parameters_blocking(
    node: str | Node, given: dict[str, object] | None = None, /, *, atomically: bool = False, **values: object
) -> Outcome:
    """See `set_parameters`; this is the same for programs and for threads without an event loop."""
    name = full_name(node)
    with _wait_for_events() as waiting:
        outcome = _ask_blocking(name, _ask_to_set(name, {**(given or {}), **values}, atomically=atomically), _TIMEOUT)
        waiting.wait(outcome.events)
    return outcome


@to_be_awaited("lab.describe_parameters")
async def describe_parameters(node: str | Node, /, *, timeout: float = _TIMEOUT) -> Descriptors:
    """What a node says about its parameters: name, type, description, range, read_only, constraints.

    Returns:
        a list that prints one parameter after the other, those that every node has last.

    Raises:
        NodeNotFoundError: no such node has parameters.
        NoAnswerError: nothing came back in time.
    """
    return await _ask(full_name(node), _ask_for_descriptors(), timeout)


def describe_parameters_blocking(node: str | Node, /, *, timeout: float = _TIMEOUT) -> Descriptors:
    """See `describe_parameters`; this is the same for programs and for threads without an event loop."""
    return _ask_blocking(full_name(node), _ask_for_descriptors(), timeout)


def full_name(node: str | Node) -> str:
    """A node's fully qualified name, for a name or the node itself; one without a slash is in the root namespace.

    Raises:
        LabError: it is neither.
    """
    if hasattr(node, "get_fully_qualified_name"):
        return str(node.get_fully_qualified_name())
    if not isinstance(node, str) or not node.strip("/"):
        raise LabError(f'The node comes first, by its name such as "/parameter_node": {node!r} is not one.')
    return "/" + node.strip("/")


def _ask_for_values(node: str, wanted: tuple[str, ...]) -> Steps[Values]:
    asked = list(wanted) or (yield from _ask_own_first())
    found = yield from parameters.ask_values(asked)
    if any(value.type == 0 for value in found):
        known = yield from parameters.ask_names()
        for name in asked:
            if name not in known:
                raise ParameterNotFoundError(f"There is no parameter {name!r}: {_list_declared(node, name, known)}")
    return Values(zip(asked, map(parameters.from_message, found), strict=True))


def _ask_to_set(node: str, values: dict[str, object], *, atomically: bool) -> Steps[Outcome]:
    if not values:
        raise LabError('Say what to set: lab.set_parameters("/node", name=value).')
    try:
        messages = yield from _make_messages(values)
    except BadFieldError as error:
        raise FieldError(str(error)) from None
    if atomically:
        results = [(yield from parameters.set_together(messages))] * len(values)
    else:
        results = yield from parameters.set_each(messages)
    reasons = {name: each.reason for name, each in zip(values, results, strict=True) if not each.successful}
    if any("declared" in reason for reason in reasons.values()):
        unknown = yield from _find_undeclared(node, list(reasons))
        if atomically:  # one reason for all
            reasons = dict.fromkeys(reasons, *list(unknown.values())[:1]) if unknown else reasons
        reasons |= unknown
    return Outcome(node, values, reasons, atomically=atomically)


def _make_messages(given: dict[str, object]) -> Steps[list[Parameter]]:
    """The parameters with these values; the node is asked what an empty list is a list of."""
    kinds: dict[str, int] = {}
    for name, value in given.items():
        if not isinstance(value, str) and hasattr(value, "__len__") and len(value) == 0:
            types = (yield Question("get_parameter_types", {"names": [name]})).types
            kinds.update(dict.fromkeys([name], *types[:1]))
    return [parameters.to_message(name, value, kinds.get(name)) for name, value in given.items()]


def _find_undeclared(node: str, wanted: list[str]) -> Steps[dict[str, str]]:
    """Those of the names that the node has not declared, and what it has instead; rclpy's own text names neither."""
    known = yield from parameters.ask_names()
    unknown = [name for name in wanted if name not in known]
    return {name: f"there is no parameter {name!r}: {_list_declared(node, name, known)}" for name in unknown}


def _ask_for_descriptors() -> Steps[Descriptors]:
    known = yield from _ask_own_first()
    return Descriptors(map(Descriptor.from_message, (yield from parameters.ask_descriptors(known))))


def _ask_own_first() -> Steps[list[str]]:
    """The node's own parameters in its order, then those that ROS 2 declares in every node."""
    return sorted((yield from parameters.ask_names()), key=parameters.is_of_every_node)


def _list_declared(node: str, name: str, known: list[str]) -> str:
    near = names.nearest_name(name, known)
    meant = f" Did you mean {near!r}?" if near else ""
    own = [name for name in known if not parameters.is_of_every_node(name)]
    return f"{node} has {', '.join(own or known) or 'none'}.{meant}"


async def _ask(node: str, steps: Steps[T], timeout: float) -> T:
    response = None
    try:
        while True:
            asked = steps.send(response)
            response = await call(f"{node}/{asked.service}", asked.interface, timeout=timeout, **asked.fields)
    except StopIteration as end:
        result: T = end.value
        return result
    except ServiceNotFoundError:
        raise _no_node(node) from None


def _ask_blocking(node: str, steps: Steps[T], timeout: float) -> T:
    try:
        return parameters.run_steps(
            steps,
            lambda asked: call_blocking(f"{node}/{asked.service}", asked.interface, timeout=timeout, **asked.fields),
        )
    except ServiceNotFoundError:
        raise _no_node(node) from None


def _no_node(node: str) -> NodeNotFoundError:
    engine = current().engine
    looking = engine.node
    nodes = set(graph.node_names(looking)) - engine.own_names
    if node in nodes:
        return NodeNotFoundError(f"{node} is on the graph but offers no parameter services.")
    services = {name for name, _ in looking.get_service_names_and_types()}
    having = sorted(node for node in nodes if node + parameters.LIST_SERVICE in services and not names.is_hidden(node))
    near = names.nearest_name(node, having)
    if near:
        return NodeNotFoundError(f"There is no node {node}. The nearest name on the graph is {near}.")
    if having:
        return NodeNotFoundError(f"There is no node {node}. On the graph: {', '.join(having[:5])}.")
    return NodeNotFoundError(f"There is no node {node}, nor any other with parameters: has it been started?")


def _wait_for_events() -> DeliveryWait:
    from rcl_interfaces.msg import ParameterEvent

    from course_kit.lab.topics import DeliveryWait

    return DeliveryWait(current().engine, "/parameter_events", ParameterEvent)


class Values(dict[str, Any]):
    """Values by name that print one a line."""

    def __repr__(self) -> str:
        return "\n".join(f"{name}: {value!r}" for name, value in self.items()) or "no parameters"


class Outcome:
    """What came of setting parameters; true if all were set."""

    def __init__(self, node: str, values: dict[str, object], reasons: dict[str, str], *, atomically: bool) -> None:
        self.node = node
        self.values = values
        self.reasons = reasons
        self._atomically = atomically

    @property
    def successful(self) -> bool:
        """Whether every parameter was set."""
        return not self.reasons

    @property
    def events(self) -> int:
        """How many messages on /parameter_events tell of it."""
        return int(self.successful) if self._atomically else len(self.values) - len(self.reasons)

    def __bool__(self) -> bool:
        return self.successful

    def __repr__(self) -> str:
        if self._atomically and self.reasons:
            reason = next(iter(self.reasons.values()))
            return f"nothing was set, because one value was refused: {reason}"
        return "\n".join(self._line(name) for name in self.values)

    def _line(self, name: str) -> str:
        value = self.values[name]
        if name not in self.reasons:
            return f"{name}: set to {value!r}"
        reason = self.reasons[name]
        return f"{name}: {value!r} was refused: {reason}{_hint(value, reason)}"


class Range(NamedTuple):
    """Limits of a number, both allowed; a step of 0 means any value between."""

    lowest: float
    highest: float
    step: float

    def __str__(self) -> str:
        steps = f" in steps of {self.step!r}" if self.step else ""
        return f"{self.lowest!r} to {self.highest!r}{steps}"


@dataclass(frozen=True, repr=False)
class Descriptor:
    """What a node says about one of its parameters."""

    name: str
    type: str
    description: str
    range: Range | None
    read_only: bool
    constraints: str

    def __repr__(self) -> str:
        facts = [self.type, str(self.range) if self.range else "", "read-only" if self.read_only else ""]
        words = [f"{self.name}: {', '.join(fact for fact in facts if fact)}"]
        words += [f"    {text}" for text in (self.description, self.constraints) if text]
        return "\n".join(words)

    @classmethod
    def from_message(cls, message: ParameterDescriptor) -> Descriptor:
        """An rcl_interfaces/msg/ParameterDescriptor in plain values."""
        limits = [*message.floating_point_range, *message.integer_range]
        found = Range(limits[0].from_value, limits[0].to_value, limits[0].step) if limits else None
        kind, constraints = parameters.type_of(message), message.additional_constraints
        return cls(message.name, kind, message.description, found, message.read_only, constraints)


class Descriptors(list[Descriptor]):
    """Descriptors that print one after the other."""

    def __repr__(self) -> str:
        return "\n".join(str(value) for value in self) or "no parameters"


def _hint(value: object, reason: str) -> str:
    """For the slip everybody makes: 1 is an integer, and a double does not take it."""
    if type(value) is int and re.match(r"wrong parameter type, expected '(Type.DOUBLE|3)'", reason, re.IGNORECASE):
        return f". {value} is an integer: write {float(value)}"
    return ""
