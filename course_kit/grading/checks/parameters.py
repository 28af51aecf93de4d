"""What graders ask of a node's parameters, through the services every node has for them.

See rcl_interfaces/srv/ListParameters, GetParameters, SetParameters and SetParametersAtomically.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically

from course_kit.grading.checks import graph
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.discovery import ENDED, answers, has_settled, other_nodes
from course_kit.grading.diagnosis import exceptions, hangs
from course_kit.grading.model.bounds import bounded
from course_kit.ros import parameters

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rcl_interfaces.msg import ParameterValue, SetParametersResult

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message
    from course_kit.ros.parameters import Question, Steps

INTERFACES = (ListParameters, GetParameters, SetParameters, SetParametersAtomically)
_VERBS = ("list_parameters", "get_parameters", "set_parameters", "set_parameters_atomically")
_QUESTIONS = _VERBS[:2]
T = TypeVar("T")


@dataclass(frozen=True)
class Value:
    """A parameter's value and its type, by the name ROS 2 has for it (`double`), or `not set`."""

    type: str
    value: Any


@dataclass(frozen=True)
class SetResult:
    """How an attempt to set went: rcl_interfaces/msg/SetParametersResult."""

    successful: bool
    reason: str

    def shown(self) -> str:
        """As the learner is shown it."""
        return "accepted" if self.successful else f"refused, with the reason {self.reason!r}"


class Remote:
    """The parameters of one node, asked from outside. Each verb may raise Failed when no answer comes."""

    def __init__(self, context: CheckContext, node: str) -> None:
        """Prepare to ask the node with the full name `node`."""
        self.node = node
        self._context = context
        self._clients = {
            verb: context.grader_node.client(interface, f"{node}/{verb}")
            for verb, interface in reversed(tuple(zip(_VERBS, INTERFACES, strict=True)))
        }

    def ready(self) -> bool:
        """Whether all its parameter services can be called."""
        return all(client.is_ready() for client in self._clients.values())

    def names(self) -> list[str]:
        """The names of all parameters of the node."""
        return self._ask(parameters.ask_names())

    def values(self, names: Sequence[str]) -> dict[str, Value]:
        """The values of these parameters; one that is not declared, or has no value yet, counts as not set."""
        return dict(zip(names, map(_value, self._ask(parameters.ask_values(names))), strict=True))

    def set(self, name: str, value: object) -> SetResult:
        """Set one parameter."""
        results = self._ask(parameters.set_each([parameters.to_message(name, value)]))
        return _result(results[0]) if results else SetResult(successful=False, reason="")

    def set_together(self, values: Mapping[str, object]) -> SetResult:
        """Set several at once, all or none, in this order."""
        messages = [parameters.to_message(*pair) for pair in values.items()]
        return _result(self._ask(parameters.set_together(messages)))

    def _ask(self, steps: Steps[T]) -> T:
        return parameters.run_steps(steps, self._answer)

    def _answer(self, question: Question) -> Message:
        context, request = self._context, question.request
        evidence = _evidence(question)
        context.require_time(evidence)
        turn = context.record.sent(evidence.sent, minor=question.service in _QUESTIONS)
        clock = context.clock()
        with exceptions.explained(context, evidence):
            sent = self._clients[question.service].send(request)
            if context.wait_until(sent.answered, hangs.ANSWER_S):
                response = bounded(sent.response())
                turn.came(_told(request, response))
                return response
            raise exceptions.unanswered(context, evidence, clock.fair())


def require_proper_answer(outcome: SetResult, evidence: Evidence) -> None:
    """A refusal is the learner's own, not rclpy's for a callback that returned something else.

    Raises:
        Failed: with parameter.bad_callback.
    """
    if exceptions.INVALID_RESULT in outcome.reason:
        message = "Your set-parameters callback did not return a SetParametersResult, so rclpy refused the change."
        raise Failed(evidence, message, "parameter.bad_callback")


def shown(values: Mapping[str, object]) -> str:
    """`max_velocity=2.5, enabled=False`."""
    return ", ".join(f"{name}={value!r}" for name, value in values.items())


def yaml(value: object) -> str:
    """A value as YAML, for files and for `-p name:=value`."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"'{value}'" if isinstance(value, str) else repr(value)


def start_arguments(values: Mapping[str, object]) -> list[str]:
    """The arguments that start a program with these values, `--ros-args -p name:=value`."""
    return ["--ros-args", *(word for name, value in values.items() for word in ("-p", f"{name}:={yaml(value)}"))]


def parameter_file(values: Mapping[str, object], node: str) -> str:
    """A parameter file with these values, for a node of this full name or, when it is empty, for any."""
    lines = [f"    {name}: {yaml(value)}" for name, value in values.items()]
    return "\n".join([f"{node.lstrip('/') or '/**'}:", "  ros__parameters:", *lines]) + "\n"


def expect_served(context: CheckContext, node: str) -> Evidence:
    """A node of this full name is up, and answers when it is asked for its parameters.

    Raises:
        Failed: it is not; with start.*, name.node, limit.* or parameter.*.
    """
    expected = f"a node called {node}"
    remote = Remote(context, node)
    clock = context.clock()
    with exceptions.explained(context, Evidence("", expected), exceptions.of_start, ENDED):
        context.wait_for_start(lambda: remote.ready() or has_settled(context, clock))
        if not remote.ready():
            raise _not_served(context, node, expected)
        client = context.grader_node.client(
            ListParameters, f"{node}/list_parameters"
        )  # the last that `remote` has made
        clock = context.clock()
        if not answers(context, client, ListParameters.Request(), hangs.ANSWER_S):
            raise exceptions.unanswered(context, Evidence("list_parameters", expected), clock.fair())
    return Evidence("", expected, expected)


def _not_served(context: CheckContext, node: str, expected: str) -> Failed:
    nodes = context.grader_node.nodes()
    context.spoil()
    evidence = Evidence("", expected, f"on the graph: {graph.listed(nodes, 'node')}")
    if node in nodes:
        message = (
            f"The node {node} is running but has no parameter services (was it made with "
            "start_parameter_services=False?)."
        )
        return Failed(evidence, message)
    if nodes:
        return other_nodes(node, nodes, evidence)
    return Failed(evidence, *graph.why_empty(context, node)[::-1])


def _evidence(question: Question) -> Evidence:
    """What is asked and expected, as the learner is shown it."""
    if question.service == "list_parameters":
        return Evidence(question.service, "the names of all parameters")
    if question.service == "get_parameters":
        return Evidence(f"get_parameters: {', '.join(question.fields['names'])}", "their values")
    values = {one.name: parameters.from_message(one.value) for one in question.fields["parameters"]}
    return Evidence(f"{question.service}: {shown(values)}", "an answer: accepted, or refused and why")


def _told(request: Message, response: Message) -> str:
    """A response of one of the services as the learner is shown it."""
    if isinstance(response, ListParameters.Response):
        return f"names: {', '.join(response.result.names)}"
    if isinstance(response, GetParameters.Response):
        values = [_value(value).value for value in response.values]
        if len(values) != len(request.names):
            return "no values: one of these parameters is not declared, or has no value"
        return shown(dict(zip(request.names, values, strict=True)))
    results = response.results if isinstance(response, SetParameters.Response) else [response.result]
    return "; ".join(_result(one).shown() for one in results)


def _result(message: SetParametersResult) -> SetResult:
    return SetResult(message.successful, message.reason)


def _value(message: ParameterValue) -> Value:
    return Value(parameters.type_of(message), parameters.from_message(message))
