"""Ready-made checks: functions that return a check. What they look at is named in exercise.toml, `[[endpoints]]`."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks import discovery
from course_kit.grading.checks.actions import WantedAction
from course_kit.grading.checks.check import Check, Evidence, Failed
from course_kit.grading.checks.conversation import drawn_values
from course_kit.grading.checks.graded_node import ANSWER_S, GradedNode
from course_kit.grading.checks.matching import describe_wanted, interface_of
from course_kit.grading.checks.services import Service
from course_kit.grading.checks.topics import Topic, expect_endpoints

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext

DEADLINE_S = 12.0
_ENDS = ("publisher", "subscription")


def check(
    *, points: float, after: Sequence[str] = (), proves: Sequence[str] = (), deadline_s: float = DEADLINE_S
) -> Callable[[Callable[[GradedNode], object]], Check]:
    """Decorator that makes a function a check: it talks with a node, and passes when nothing it expects fails.

    The function's name is the check's id, the first line of its docstring what a learner reads.

    Args:
        points: what it is worth.
        after: ids of checks without which it makes no sense: it is skipped unless they passed.
        proves: ids of the sentences of the task that it proves.
        deadline_s: seconds for all its waiting together.

    Raises:
        ValueError: the function has no docstring, or is worth nothing.

    Example:
        >>> @check(points=1.5, after=["offered"], proves=["reset"])
        ... def reset_is_refused(node):
        ...     "While it is critical, a reset is refused."
        ...     node.send("/voltage", 9.0).expect("/state", "critical")
        ...     node.call("/reset").refused()
    """

    def declare(function: Callable[[GradedNode], object]) -> Check:
        title = (inspect.getdoc(function) or "").partition("\n")[0].rstrip(".")
        return _made(function.__name__, title, points, function, after, proves, deadline_s)

    return declare


def _made(  # noqa: PLR0913, PLR0917 - the fields of a check
    check_id: str,
    title: str,
    points: float,
    talk: Callable[[GradedNode], object],
    after: Sequence[str],
    proves: Sequence[str],
    deadline_s: float = DEADLINE_S,
) -> Check:
    if not title:
        raise ValueError(f"the check {check_id} needs a docstring: its first line is shown as the title")
    if points <= 0:
        raise ValueError(f"the check {check_id} needs points above 0")

    def run(context: CheckContext) -> Evidence:
        seen = talk(GradedNode(context))
        if isinstance(seen, Evidence):
            return seen
        sent, got = context.record.last_exchange()
        return Evidence(sent, title, got)

    return Check(check_id, title, float(points), tuple(after), deadline_s, run, tuple(proves))


def offered(
    *names: str,
    points: float,
    proves: Sequence[str],
    title: str = "",
    check_id: str = "offered",
    after: Sequence[str] = (),
) -> Check:
    """A check that the program offers the endpoints of exercise.toml, each with its type, and a default one connects.

    Args:
        names: some of the endpoints; all of them when none is named.
        points: what it is worth.
        proves: ids of the sentences of the task.
        title: one line for the learner.
        check_id: its id.
        after: ids of checks that have to pass before.

    Example:
        >>> offered(points=1.0, proves=["topics"], title="Both topics are there")
    """

    def talk(node: GradedNode) -> Evidence:
        context = node.context
        ends = [one for one in context.job.endpoints if not names or one["name"] in names]
        told = []
        node.prepare()
        for one in ends:
            if one["kind"] in ("service", "action"):
                kind: Any = Service if one["kind"] == "service" else WantedAction
                told.append(discovery.expect_offered(context, kind(one["name"], interface_of(one["type"])), node.greet))
        topics = {
            kind: [Topic(one["name"], interface_of(one["type"])) for one in ends if one["kind"] == kind]
            for kind in _ENDS
        }
        if any(topics.values()):
            discovery.await_nodes(context, [one for one in ends if one["kind"] in _ENDS])
            told.append(expect_endpoints(context, topics["publisher"], topics["subscription"]))
        expected = "; ".join(one.expected for one in told)
        return Evidence("", expected, expected)

    return _made(check_id, title or "All of its endpoints are there, with their types", points, talk, after, proves)


def node_name(name: str, *, points: float, proves: Sequence[str], after: Sequence[str] = ()) -> Check:
    """A check that the node has its name.

    Args:
        name: of the node, without a slash.
        points: what it is worth.
        proves: ids of the sentences of the task.
        after: ids of checks that have to pass before.

    Example:
        >>> node_name("battery_monitor", points=0.5, proves=["node"], after=["offered"])
    """

    def talk(node: GradedNode) -> Evidence:
        return discovery.expect_node(node.context, f"/{name}", node.meet)

    return _made("node_name", f"The node is called {name}", points, talk, after, proves)


def service_answers(  # noqa: PLR0913 - what an author may say of it
    service: str,
    requests: Sequence[dict[str, Any]],
    expect: Callable[[Any], dict[str, Any]],
    *,
    check_id: str,
    title: str,
    points: float,
    proves: Sequence[str],
    after: Sequence[str] = (),
) -> Check:
    """A check that a service answers some requests.

    Args:
        service: its name.
        requests: fields of each; a value may be a drawing, such as `between(1, 99)`.
        expect: gives the fields of the right response for a request.
        check_id: its id.
        title: one line for the learner.
        points: what it is worth.
        proves: ids of the sentences of the task.
        after: ids of checks that have to pass before.

    Example:
        >>> service_answers("/add", [{"a": 1, "b": between(-9, 9)}] * 3, lambda request: {"sum": request.a + request.b},
        ...                 check_id="sum", title="/add answers with the sum", points=1.0, proves=["sum"])
    """

    def talk(node: GradedNode) -> None:
        for fields in drawn_values(requests, node.context.random):
            answer = node.call(service, fields)
            answer.expect(**expect(node.request(service, fields)))

    return _made(check_id, title, points, talk, after, proves)


def topic_answers(  # noqa: PLR0913 - what an author may say of it
    subscription: str,
    publisher: str,
    messages: Sequence[Any],
    expect: Callable[[Any], Any],
    *,
    check_id: str,
    title: str,
    points: float,
    proves: Sequence[str],
    after: Sequence[str] = (),
    within_s: float = ANSWER_S,
) -> Check:
    """A check that each message on one topic is answered by exactly one on another.

    Args:
        subscription: the topic of the messages that are sent.
        publisher: the topic of the answers.
        messages: what is sent: a value of the only field, a dict, or a drawing.
        expect: gives what a right answer is for a message.
        check_id: its id.
        title: one line for the learner.
        points: what it is worth.
        proves: ids of the sentences of the task.
        after: ids of checks that have to pass before.
        within_s: seconds in which the answer comes.

    Example:
        >>> topic_answers("/brightness", "/lamp", [0.5, 0.500001, between(0.0, 0.499), 1.0], lambda m: m.data > 0.5,
        ...               check_id="switches", title="The lamp is on above 0.5", points=1.0, proves=["threshold"])
    """

    def talk(node: GradedNode) -> None:
        for one in drawn_values(messages, node.context.random):
            made = node.message(subscription, one)
            node.send(subscription, made).expect(publisher, expect(made), within_s=within_s)
        node.expect_nothing(publisher, why=f"Publish once on {publisher} for each message.")

    return _made(check_id, title, points, talk, after, proves)


def topic_silent(  # noqa: PLR0913 - what an author may say of it
    *topics: str,
    seconds: float = 1.0,
    check_id: str,
    title: str,
    points: float,
    proves: Sequence[str],
    after: Sequence[str] = (),
) -> Check:
    """A check that nothing comes on some topics while nothing is sent.

    Args:
        topics: their names.
        seconds: for how long.
        check_id: its id.
        title: one line for the learner.
        points: what it is worth.
        proves: ids of the sentences of the task.
        after: ids of checks that have to pass before.

    Example:
        >>> topic_silent("/alarm", check_id="quiet", title="No alarm without a cause", points=1.0, proves=["quiet"])
    """
    return _made(check_id, title, points, lambda node: node.expect_nothing(*topics, seconds=seconds), after, proves)


def parameter_declared(  # noqa: PLR0913 - what an author may say of it
    defaults: dict[str, Any],
    *,
    node: str,
    check_id: str,
    title: str,
    points: float,
    proves: Sequence[str],
    after: Sequence[str] = (),
) -> Check:
    """A check that a node has parameters, with these values at the start, and so with their types.

    Args:
        defaults: by the parameters' names.
        node: its full name.
        check_id: its id.
        title: one line for the learner.
        points: what it is worth.
        proves: ids of the sentences of the task.
        after: ids of checks that have to pass before.

    Example:
        >>> parameter_declared({"max_speed": 1.0}, node="/speed_limiter", check_id="declared",
        ...                    title="max_speed is 1.0 at the start", points=1.0, proves=["parameter"])
    """

    def talk(graded: GradedNode) -> Evidence:
        graded.meet()
        remote = graded.parameters(node)
        names, found = remote.names(), remote.values(list(defaults))
        evidence = Evidence(
            "get_parameters", describe_wanted(defaults), describe_wanted({k: v.value for k, v in found.items()})
        )
        if missing := [name for name in defaults if name not in names]:
            raise Failed(evidence, f"Your node has not declared {', '.join(missing)}.", "parameter.undeclared")
        if wrong := [name for name, value in defaults.items() if type(found[name].value) is not type(value)]:
            point = " A double needs a decimal point." if any(found[name].type == "integer" for name in wrong) else ""
            told = " and ".join(f"{name} is {found[name].type}" for name in wrong)
            raise Failed(evidence, f"{told}.{point}", "parameter.type")
        if others := {name: found[name].value for name, value in defaults.items() if found[name].value != value}:
            raise Failed(
                evidence, f"Started without settings, your node has {describe_wanted(others)}.", "parameter.default"
            )
        return evidence

    return _made(check_id, title, points, talk, after, proves)
