"""What graders ask of a node's parameters, through the services every node has for them.

See rcl_interfaces/srv/ListParameters, GetParameters, SetParameters and SetParametersAtomically.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter, parameter_value_to_python

from course_kit.grading import callbacks, graph, silence
from course_kit.grading.asking import get_known
from course_kit.grading.bench import SubmissionEndedError
from course_kit.grading.bounds import bounded
from course_kit.grading.checks import Evidence, Failed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rcl_interfaces.msg import Parameter as ParameterMessage

    from course_kit.grading.bench import Bench

INTERFACES = (ListParameters, GetParameters, SetParameters, SetParametersAtomically)
_VERBS = ("list_parameters", "get_parameters", "set_parameters", "set_parameters_atomically")
_QUESTIONS = _VERBS[:2]
_SETTLED_S = 2.0  # a node that is up and spinning for so long has the name it will have
NOT_SET = "not set"  # the type of a parameter without a value


@dataclass(frozen=True)
class Value:
    """A parameter's value and its type, by the name ROS 2 has for it (`double`), or `not set`."""

    type: str
    value: Any


@dataclass(frozen=True)
class Outcome:
    """How an attempt to set went: rcl_interfaces/msg/SetParametersResult."""

    successful: bool
    reason: str

    def shown(self) -> str:
        """As the learner is shown it."""
        return "it was accepted" if self.successful else f"it was refused, with the reason {self.reason!r}"


class Remote:
    """The parameters of one node, asked from outside. Each verb may raise Failed when no answer comes.

    Attributes:
        node: the node's full name.
        changed: whether it was asked to change something.
    """

    def __init__(self, bench: Bench, node: str) -> None:
        """Prepare to ask the node with the full name `node`."""
        self.node = node
        self.changed = False
        self._bench = bench
        self._clients = {
            verb: bench.tester.client(interface, f"{node}/{verb}")
            for verb, interface in reversed(tuple(zip(_VERBS, INTERFACES, strict=True)))
        }

    def ready(self) -> bool:
        """Whether all its parameter services can be called."""
        return all(client.service_is_ready() for client in self._clients.values())

    def names(self) -> list[str]:
        """The names of all parameters of the node."""
        evidence = Evidence("list_parameters", "the names of all parameters")
        return list(self._call("list_parameters", ListParameters.Request(), evidence).result.names)

    def values(self, names: Sequence[str]) -> dict[str, Value]:
        """The values of these parameters; one that is not declared, or has no value yet, counts as not set."""
        found = self._get(names)
        if len(found) != len(names):  # rclpy answers for all or for none
            found = [next(iter(self._get([name])), ParameterValue()) for name in names]
        return {name: _value(value) for name, value in zip(names, found, strict=True)}

    def set(self, name: str, value: Any) -> Outcome:
        """Set one parameter."""
        self.changed = True
        request = SetParameters.Request(parameters=[_message(name, value)])
        evidence = Evidence(f"set_parameters: {shown({name: value})}", "an answer: accepted, or refused and why")
        results = self._call("set_parameters", request, evidence).results
        return Outcome(results[0].successful, results[0].reason) if results else Outcome(successful=False, reason="")

    def set_together(self, values: Mapping[str, Any]) -> Outcome:
        """Set several at once, all or none, in this order."""
        self.changed = True
        request = SetParametersAtomically.Request(parameters=[_message(*pair) for pair in values.items()])
        evidence = Evidence(f"set_parameters_atomically: {shown(values)}", "an answer: accepted, or refused and why")
        result = self._call("set_parameters_atomically", request, evidence).result
        return Outcome(result.successful, result.reason)

    def _get(self, names: Sequence[str]) -> list[ParameterValue]:
        evidence = Evidence(f"get_parameters: {', '.join(names)}", "their values")
        return list(self._call("get_parameters", GetParameters.Request(names=list(names)), evidence).values)

    def _call(self, verb: str, request: Any, evidence: Evidence) -> Any:
        bench = self._bench
        bench.require_time(evidence)
        turn = bench.record.sent(evidence.sent, minor=verb in _QUESTIONS)
        clock = bench.clock()
        with callbacks.explained(bench, evidence):
            future = self._clients[verb].call_async(request)
            if bench.wait_until(future.done, silence.ANSWER_S):
                response = bounded(future.result())
                turn.came(_told(request, response))
                return response
            raise callbacks.unanswered(bench, evidence, clock.fair())


def shown(values: Mapping[str, Any]) -> str:
    """`max_velocity=2.5, enabled=False`."""
    return ", ".join(f"{name}={value!r}" for name, value in values.items())


def expect_served(bench: Bench, node: str) -> Evidence:
    """A node of this full name is up, and answers when it is asked for its parameters.

    Raises:
        Failed: it is not; with start.*, name.node, limit.* or parameter.*.
    """
    expected = f"a node called {node}"
    remote = Remote(bench, node)
    clock = bench.clock()

    def settled() -> bool:
        return clock.past(_SETTLED_S) and bool(bench.tester.nodes()) and silence.spins(bench)

    try:
        bench.wait_for_start(lambda: remote.ready() or settled())
        if not remote.ready():
            raise _not_served(bench, node, expected)
        client = bench.tester.client(ListParameters, f"{node}/list_parameters")  # the last that `remote` has made
        clock = bench.clock()
        if not get_known(bench, client, ListParameters.Request(), silence.ANSWER_S):
            raise callbacks.unanswered(bench, Evidence("list_parameters", expected), clock.fair())
    except SubmissionEndedError as ended:
        diagnosis, message = callbacks.of_start(ended.life, bench.job)
        raise Failed(Evidence("", expected, "a program that has ended"), message, diagnosis) from None
    return Evidence("", expected, expected)


def ensure_served(bench: Bench, node: str) -> Remote:
    """The parameters of a running submission: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up a second time.
    """
    if bench.spoiled:
        bench.launch()
        try:
            expect_served(bench, node)
        except Failed as failed:
            bench.spoil()
            message = f"An earlier check ended your program, and started again it did not come up. {failed.message}"
            raise Failed(failed.evidence, message, failed.diagnosis) from None
    return Remote(bench, node)


def _not_served(bench: Bench, node: str, expected: str) -> Failed:
    nodes = bench.tester.nodes()
    bench.spoil()
    evidence = Evidence("", expected, f"on the graph: {graph.listed(nodes, 'node')}")
    if node in nodes:
        message = f"The node {node} is up, and offers no services for its parameters (start_parameter_services)."
        return Failed(evidence, message)
    if nodes:
        message = f"The graph has {graph.listed(nodes, 'node')}, and none is called {node}.{graph.closest(node, nodes)}"
        return Failed(evidence, message, "name.node")
    return Failed(evidence, *graph.why_empty(bench, node)[::-1])


def _told(request: Any, response: Any) -> str:
    """A response of one of the services as the learner is shown it."""
    if isinstance(response, ListParameters.Response):
        return f"names: {', '.join(response.result.names)}"
    if isinstance(response, GetParameters.Response):
        values = [_value(value).value for value in response.values]
        if len(values) != len(request.names):
            return "no values: something that was asked for is not declared, or not set"
        return shown(dict(zip(request.names, values, strict=True)))
    results = response.results if isinstance(response, SetParameters.Response) else [response.result]
    return "; ".join(Outcome(one.successful, one.reason).shown() for one in results)


def _value(message: ParameterValue) -> Value:
    if message.type == Parameter.Type.NOT_SET.value:
        return Value(NOT_SET, None)
    try:
        kind = Parameter.Type(message.type)
    except ValueError:  # by a node that answers these requests itself
        return Value(f"of the unknown type {message.type}", None)
    return Value(str(kind.name).lower(), parameter_value_to_python(message))


def _message(name: str, value: Any) -> ParameterMessage:
    return Parameter(name, value=value).to_parameter_msg()
