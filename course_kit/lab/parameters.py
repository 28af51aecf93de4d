"""Parameters of any node on the graph, over its parameter services, as `ros2 param` does it.

Each verb is written once, as a generator that yields a question for a service and is sent the response; it is driven
by asyncio in a notebook and by a wait in a program.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from course_kit.lab import graph
from course_kit.lab.errors import LabError, NodeNotFoundError, ParameterNotFoundError, ServiceNotFoundError
from course_kit.lab.parameter_events import ParameterEventWait
from course_kit.lab.parameter_values import (
    Descriptors,
    Outcome,
    Values,
    described,
    from_message,
    is_empty_list,
    is_of_every_node,
    own_first,
    to_message,
)

if TYPE_CHECKING:
    from collections.abc import Generator

    from course_kit.lab.runtime.core import Lab

T = TypeVar("T")
_TIMEOUT = 5.0  # seconds for each answer
_SERVICE = "/list_parameters"  # a node that has it has parameter services


class Question(NamedTuple):
    """A call that a verb wants made.

    Attributes:
        service: which of the node's parameter services, such as "get_parameters".
        fields: the request's.
    """

    service: str
    fields: dict[str, Any]


if TYPE_CHECKING:
    Steps = Generator[Question, Any, T]


async def get_parameters(node: Any, /, *names: str, timeout: float = _TIMEOUT) -> Values:
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
    return await _ask(name, _getting(name, names), timeout)


def get_parameters_blocking(node: Any, /, *names: str, timeout: float = _TIMEOUT) -> Values:
    """The same as `get_parameters` for programs and for threads without an event loop."""
    name = full_name(node)
    return _ask_blocking(name, _getting(name, names), timeout)


async def set_parameters(
    node: Any, given: dict[str, Any] | None = None, /, *, atomically: bool = False, **values: Any
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
    with ParameterEventWait() as hearing:
        outcome = await _ask(name, _setting(name, {**(given or {}), **values}, atomically=atomically), _TIMEOUT)
        if hearing.expects(outcome.events):
            await asyncio.to_thread(hearing.wait)
    return outcome


def set_parameters_blocking(
    node: Any, given: dict[str, Any] | None = None, /, *, atomically: bool = False, **values: Any
) -> Outcome:
    """The same as `set_parameters` for programs and for threads without an event loop."""
    name = full_name(node)
    with ParameterEventWait() as hearing:
        outcome = _ask_blocking(name, _setting(name, {**(given or {}), **values}, atomically=atomically), _TIMEOUT)
        if hearing.expects(outcome.events):
            hearing.wait()
    return outcome


async def describe_parameters(node: Any, /, *, timeout: float = _TIMEOUT) -> Descriptors:
    """What a node says about its parameters: name, type, description, range, read_only, constraints.

    Returns:
        a list that prints one parameter after the other, those that every node has last.

    Raises:
        NodeNotFoundError: no such node has parameters.
        NoAnswerError: nothing came back in time.
    """
    return await _ask(full_name(node), _describing(), timeout)


def describe_parameters_blocking(node: Any, /, *, timeout: float = _TIMEOUT) -> Descriptors:
    """The same as `describe_parameters` for programs and for threads without an event loop."""
    return _ask_blocking(full_name(node), _describing(), timeout)


def full_name(node: Any) -> str:
    """A node's fully qualified name, for a name or the node itself; one without a slash is in the root namespace.

    Raises:
        LabError: it is neither.
    """
    if hasattr(node, "get_fully_qualified_name"):
        return str(node.get_fully_qualified_name())
    if not isinstance(node, str) or not node.strip("/"):
        raise LabError(f'The node comes first, by its name such as "/parameter_node": {node!r} is not one.')
    return "/" + node.strip("/")


def _getting(node: str, wanted: tuple[str, ...]) -> Steps[Values]:
    names = list(wanted) or own_first((yield Question("list_parameters", {})).result.names)
    values = (yield Question("get_parameters", {"names": names})).values
    if len(values) != len(names):  # one of them has no value, so that the node has answered nothing at all
        known = (yield Question("list_parameters", {})).result.names
        for name in names:
            if name not in known:
                raise ParameterNotFoundError(f"There is no parameter {name!r}: {_declared(node, name, known)}")
        values = []
        for name in names:
            values += list((yield Question("get_parameters", {"names": [name]})).values) or [None]
    pairs = zip(names, values, strict=True)
    return Values({name: None if value is None else from_message(value) for name, value in pairs})


def _setting(node: str, values: dict[str, Any], *, atomically: bool) -> Steps[Outcome]:
    if not values:
        raise LabError('Say what to set: lab.set_parameters("/node", name=value).')
    kinds = {}
    for name in [name for name, value in values.items() if is_empty_list(value)]:
        types = (yield Question("get_parameter_types", {"names": [name]})).types  # the node knows what it is a list of
        kinds.update(dict.fromkeys([name], *types) if types else {})
    parameters = [to_message(name, value, kinds.get(name)) for name, value in values.items()]
    if atomically:
        result = (yield Question("set_parameters_atomically", {"parameters": parameters})).result
        results = [result] * len(values)
    else:
        results = (yield Question("set_parameters", {"parameters": parameters})).results
    reasons = {name: each.reason for name, each in zip(values, results, strict=True) if not each.successful}
    if any("declared" in reason for reason in reasons.values()):
        unknown = yield from _undeclared(node, list(reasons))
        if atomically:  # one reason for all
            reasons = dict.fromkeys(reasons, *list(unknown.values())[:1]) if unknown else reasons
        reasons |= unknown
    return Outcome(node, values, reasons, atomically=atomically)


def _undeclared(node: str, names: list[str]) -> Steps[dict[str, str]]:
    """Those of the names that the node has not declared, and what it has instead; rclpy's own text names neither."""
    known = (yield Question("list_parameters", {})).result.names
    unknown = [name for name in names if name not in known]
    return {name: f"there is no parameter {name!r}: {_declared(node, name, known)}" for name in unknown}


def _describing() -> Steps[Descriptors]:
    names = own_first((yield Question("list_parameters", {})).result.names)
    descriptors = (yield Question("describe_parameters", {"names": names})).descriptors
    for name, descriptor in zip(names, descriptors, strict=True):
        descriptor.name = name  # rclpy gives all parameters declared with one descriptor object the last one's name
    return Descriptors(described(one) for one in descriptors)


def _declared(node: str, name: str, known: list[str]) -> str:
    near = graph.nearest(name, known)
    meant = f" Did you mean {near!r}?" if near else ""
    own = [one for one in known if not is_of_every_node(one)]
    return f"{node} has {', '.join(own or known) or 'none'}.{meant}"


async def _ask(node: str, steps: Steps[T], timeout: float) -> T:
    from course_kit.lab.api import call
    from course_kit.lab.singleton import current

    try:
        question = next(steps)
        while True:
            try:
                response = await call(*_of(node, question), timeout=timeout, **question.fields)
            except ServiceNotFoundError:
                raise _no_node(current(), node) from None
            question = steps.send(response)
    except StopIteration as end:
        result: T = end.value
        return result


def _ask_blocking(node: str, steps: Steps[T], timeout: float) -> T:
    from course_kit.lab.api import call_blocking
    from course_kit.lab.singleton import current

    try:
        question = next(steps)
        while True:
            try:
                response = call_blocking(*_of(node, question), timeout=timeout, **question.fields)
            except ServiceNotFoundError:
                raise _no_node(current(), node) from None
            question = steps.send(response)
    except StopIteration as end:
        result: T = end.value
        return result


def _of(node: str, question: Question) -> tuple[str, Any]:
    """The service and its type."""
    import rcl_interfaces.srv

    type_name = "".join(word.capitalize() for word in question.service.split("_"))
    return f"{node}/{question.service}", getattr(rcl_interfaces.srv, type_name)


def _no_node(lab: Lab, node: str) -> NodeNotFoundError:
    """Why the parameter services of a node were not found."""
    looking = lab.engine.node
    names = {graph.full_name(*one) for one in looking.get_node_names_and_namespaces()} - lab.engine.own_names
    if node in names:
        return NodeNotFoundError(f"{node} is on the graph but offers no parameter services.")
    services = {name for name, _ in looking.get_service_names_and_types()}
    having = sorted(name for name in names if name + _SERVICE in services and "/_" not in name)
    near = graph.nearest(node, having)
    if near:
        return NodeNotFoundError(f"There is no node {node}. The nearest name on the graph is {near}.")
    if having:
        return NodeNotFoundError(f"There is no node {node}. On the graph: {', '.join(having[:5])}.")
    return NodeNotFoundError(f"There is no node {node}, nor any other with parameters: has it been started?")
