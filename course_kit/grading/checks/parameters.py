"""What graders ask of a node's parameters, through the services every node has for them.

See rcl_interfaces/srv/ListParameters, GetParameters, SetParameters and SetParametersAtomically.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from rcl_interfaces.msg import SetParametersResult

from course_kit.grading.checks import hangs
from course_kit.grading.checks.answers import describe_value
from course_kit.grading.checks.context import ANSWER_S
from course_kit.grading.checks.discovery import ENDED, await_start, explain_other_nodes, list_nodes, why_empty
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.diagnosis import causes
from course_kit.ros import parameters

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from rcl_interfaces.msg import Parameter

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message
    from course_kit.ros.parameters import Question, Steps

_IN_YAML = {"True": "true", "False": "false", "nan": ".nan", "inf": ".inf", "-inf": "-.inf"}
_VERBS = ("set_parameters_atomically", "set_parameters", "get_parameters", "list_parameters")  # made last by a node
T = TypeVar("T")


class RemoteParameters:
    """The parameters of one node, asked from outside. Each verb may raise Failed when no answer comes."""

    def __init__(self, context: CheckContext, node: str) -> None:
        """Prepare to ask the node with the full name `node`."""
        self.node = node
        self._context = context
        types = {verb: parameters.Question(verb, {}).interface for verb in _VERBS}
        self._clients = {verb: context.grader_node.client(kind, f"{node}/{verb}") for verb, kind in types.items()}

    def is_ready(self) -> bool:
        """Whether all its parameter services can be called."""
        return all(client.is_ready() for client in self._clients.values())

    def values(self, names: Iterable[str]) -> dict[str, Any]:
        """Their values, or None."""
        wanted = list(names)

        def ask() -> Steps[dict[str, Any]]:
            found = yield from parameters.ask_values(wanted)
            return {name: parameters.from_message(value) for name, value in zip(wanted, found, strict=True)}

        return self._ask(ask(), f"get_parameters: {', '.join(wanted)}", "their values", minor=True)

    def set_values(self, values: Mapping[str, object]) -> SetParametersResult:
        """Set one parameter, or several at once: all or none, in this order."""
        messages = [parameters.to_message(*pair) for pair in values.items()]
        several, expected = len(messages) > 1, "an answer: accepted, or refused and why"
        sent = f"set_parameters{'_atomically' * several}: {describe_value(values)}"
        steps = parameters.set_together(messages) if several else _set_one(messages)
        return self._ask(steps, sent, expected)

    def expect_served(self) -> Evidence:
        """The node, of a program that was just started, is up and answers when it is asked for its parameters."""
        context, expected = self._context, f"a node called {self.node}"
        await_start(context, expected, self.is_ready)
        if not self.is_ready():
            raise self._explain_absence(expected)
        clock, question = context.clock(), parameters.Question("list_parameters", {})
        with hangs.explain_end(context, Evidence("", expected), causes.explain_start, ENDED):
            if not hangs.is_answered(context, self._clients[question.service], question.request, ANSWER_S):
                evidence = Evidence(question.service, expected)
                raise hangs.explain_no_answer(context, evidence, clock.fair_s(), causes.explain_logged)
        return Evidence("", expected, expected)

    def expect_declared(
        self, values: Mapping[str, Any], why: str = "", diagnosis: str | None = "parameter.default"
    ) -> Evidence:
        """The node, which was just started, has parameters with these names, types and values; why not, if not."""
        self.expect_names(values)
        self.expect_types(values)
        return self.expect_values(values, why, diagnosis)

    def expect_names(self, names: Iterable[str]) -> Evidence:
        """It has parameters with these names."""
        found = self._ask(parameters.ask_names(), "list_parameters", "the names of all parameters", minor=True)
        evidence = Evidence(f"list_parameters of {self.node}", ", ".join(names), ", ".join(found) or "no parameters")
        if missing := [name for name in names if name not in found]:
            raise Failed(evidence, f"{self.node} has not declared {', '.join(missing)}.", "parameter.undeclared")
        return evidence

    def expect_types(self, values: Mapping[str, Any]) -> Evidence:
        """Its parameters have the types of these values."""
        found, wanted = _types_of(self.values(values)), _types_of(values)
        told, expected = (", ".join(f"{name}: {kind}" for name, kind in kinds.items()) for kinds in (found, wanted))
        evidence = Evidence(f"get_parameters of {self.node}", expected, told)
        if empty := [name for name, kind in found.items() if kind == parameters.NOT_SET]:
            why = f"{' and '.join(empty)} is declared without a value, so there is nothing to read."
            raise Failed(evidence, why, "parameter.default")
        if wrong := [name for name, kind in found.items() if kind != wanted[name]]:
            why = " and ".join(f"{name} is {found[name]}, expected {wanted[name]}" for name in wrong)
            point = any((found[name], wanted[name]) == ("integer", "double") for name in wrong)
            raise Failed(evidence, f"{why}.{' A double needs a decimal point.' if point else ''}", "parameter.type")
        return evidence

    def expect_values(
        self, values: Mapping[str, Any], why: str = "", diagnosis: str | None = "parameter.default"
    ) -> Evidence:
        """Its parameters have these values after the start."""
        found = self.values(values)
        evidence = Evidence(f"get_parameters of {self.node}", describe_value(values), describe_value(found))
        if others := {name: value for name, value in found.items() if value != values[name]}:
            wanted = describe_value({name: values[name] for name in others})
            text = f"After its start, {self.node} has {describe_value(others)}, expected {wanted}. {why}"
            raise Failed(evidence, text.rstrip(), diagnosis)
        return evidence

    def _explain_absence(self, expected: str) -> Failed:
        context, nodes = self._context, self._context.grader_node.nodes()
        context.spoil()
        evidence = Evidence("", expected, f"on the graph: {list_nodes(nodes)}")
        if self.node in nodes:
            why = "is running but has no parameter services (was it made with start_parameter_services=False?)."
            return Failed(evidence, f"The node {self.node} {why}")
        died = context.job.launches and causes.explain_logged(context.program.status().stderr, context.job)
        if died:  # one of several programs, while the others run on
            return Failed(evidence, *died[::-1])
        if nodes:
            return explain_other_nodes(self.node, nodes)
        return Failed(evidence, *why_empty(context, self.node)[::-1])

    def _ask(self, steps: Steps[T], sent: str, expected: str, *, minor: bool = False) -> T:
        context, evidence = self._context, Evidence(sent, expected)
        turn = context.record.add_sent(sent, minor=minor)

        def answer(question: Question) -> Message:
            asked = self._clients[question.service].send(question.request)
            ended, logged = causes.explain_end, causes.explain_logged
            hangs.await_answer(context, asked.is_answered, evidence, ended=ended, logged=logged)
            return asked.response()

        found = parameters.run_steps(steps, answer)
        turn.add_received(describe_result(found) if isinstance(found, SetParametersResult) else describe_value(found))
        return found


def _set_one(messages: Sequence[Parameter]) -> Steps[SetParametersResult]:
    return next(iter((yield from parameters.set_each(messages))), SetParametersResult())


def _types_of(values: Mapping[str, Any]) -> dict[str, str]:
    return {name: parameters.type_of(parameters.to_message(name, value).value) for name, value in values.items()}


def describe_result(result: SetParametersResult) -> str:
    """How an attempt to set went, as the learner is shown it."""
    return "accepted" if result.successful else f"refused, with the reason {result.reason!r}"


def start_arguments(values: Mapping[str, object]) -> list[str]:
    """The arguments that start a program with these values, `--ros-args -p name:=value`."""
    return ["--ros-args", *(word for name, value in values.items() for word in ("-p", f"{name}:={_to_yaml(value)}"))]


def parameter_file(values: Mapping[str, object], node: str) -> str:
    """A parameter file with these values, for a node of this full name or, when it is empty, for any."""
    lines = [f"    {name}: {_to_yaml(value)}" for name, value in values.items()]
    return "\n".join([f"{node.lstrip('/') or '/**'}:", "  ros__parameters:", *lines]) + "\n"


def _to_yaml(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_to_yaml, value))}]"
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    return _IN_YAML.get(repr(value), repr(value))
