"""Ready-made checks: functions that return a check. What they look at is named in exercise.toml, `[[endpoints]]`."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks import discovery
from course_kit.grading.checks.actions import WantedAction
from course_kit.grading.checks.check import Check, Evidence, Failed, require_declared
from course_kit.grading.checks.drawing import drawn_values
from course_kit.grading.checks.endpoints import Service, Topic
from course_kit.grading.checks.graded_node import ANSWER_S, GradedNode
from course_kit.grading.checks.matching import Close, differences, interface_of, only_field
from course_kit.grading.checks.topics import expect_endpoints
from course_kit.grading.diagnosis import hangs

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext

DEADLINE_S = 12.0
_TOGETHER_S = 5.0
_AT_ONCE_S = 0.05  # in which a second message of the same callback comes
_FEWEST = 3  # messages; enough to forget one that a busy machine has delayed
_SILENT_S = 2.0
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
        return made(function.__name__, title, points, function, after, proves, deadline_s)

    return declare


def made(  # noqa: PLR0913, PLR0917 - the fields of a check
    check_id: str,
    title: str,
    points: float,
    talk: Callable[[GradedNode], object],
    after: Sequence[str],
    proves: Sequence[str],
    deadline_s: float = DEADLINE_S,
) -> Check:
    """A check of what a function does with a node; see `check`.

    Raises:
        ValueError: it has no title, or is worth nothing.
    """
    require_declared(check_id, title, points)

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
                told.append(discovery.expect_offered(context, kind(one["name"], interface_of(one["type"]))))
        topics = {
            kind: [Topic(one["name"], interface_of(one["type"])) for one in ends if one["kind"] == kind]
            for kind in _ENDS
        }
        if any(topics.values()):
            discovery.await_nodes(context, [one for one in ends if one["kind"] in _ENDS])
            told.append(expect_endpoints(context, topics["publisher"], topics["subscription"]))
        expected = "; ".join(one.expected for one in told)
        return Evidence("", expected, expected)

    return made(check_id, title or "All of its endpoints are there, with their types", points, talk, after, proves)


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

    return made("node_name", f"The node is called {name}", points, talk, after, proves)


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
    within_s: float | None = None,
    not_before_s: float = 0.0,
    at_a_time: int = 0,
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
        within_s: seconds in which an answer comes; with `at_a_time`, in which all do.
        not_before_s: seconds before which none comes, where the work takes its time.
        at_a_time: ask so many at the same time, each by another client; one after the other when 0.

    Example:
        >>> service_answers("/add", [{"a": 1, "b": between(-9, 9)}] * 3, lambda request: {"sum": request.a + request.b},
        ...                 check_id="sum", title="/add answers with the sum", points=1.0, proves=["sum"])
    """

    def talk(node: GradedNode) -> None:
        several = drawn_values(requests, node.context.random)
        wanted = [expect(node.request(service, fields)) for fields in several]
        if at_a_time:
            seconds = _TOGETHER_S if within_s is None else within_s
            answers = node.call_together(service, several, at_a_time=at_a_time, within_s=seconds)
        else:
            answers = [node.call(service, fields) for fields in several]
        for answer, fields in zip(answers, wanted, strict=True):
            if not at_a_time:
                answer.not_before(not_before_s)
                answer.within(hangs.ANSWER_S if within_s is None else within_s)
            code, why = _cause(node, fields, answer.response), ""
            if answer.response == type(answer.response)():
                code, why = None, "The response came back as ROS 2 creates it: your callback filled in nothing."
            if at_a_time and any(not list(differences(one, answer.response)) for one in wanted):
                code = None
                why = "This is the answer to another client's request: your callback mixes up values of two calls."
            answer.expect(**fields, diagnosis=code, why=why)

    return made(check_id, title, points, talk, after, proves)


def service_refuses(  # noqa: PLR0913 - what an author may say of it
    service: str,
    requests: Sequence[dict[str, Any]],
    *,
    check_id: str,
    title: str,
    points: float,
    proves: Sequence[str],
    after: Sequence[str] = (),
    refused: dict[str, Any] | None = None,
    reason: str = "message",
    what: str = "a request that it has to refuse",
    valid: dict[str, Any] | None = None,
) -> Check:
    """A check that a service refuses some requests, says why, and lives on.

    Args:
        service: its name.
        requests: fields of each; a value may be a drawing.
        check_id: its id.
        title: one line for the learner.
        points: what it is worth.
        proves: ids of the sentences of the task.
        after: ids of checks that have to pass before.
        refused: the fields by which a refusal is known; `success=False` when left out.
        reason: the field that says why, "" where the task asks for no reason.
        what: is wrong with these requests, for the learner.
        valid: a request that is asked afterwards, and must not be refused.

    Example:
        >>> service_refuses("/divide", [{"a": between(1, 9), "b": 0}], valid={"a": 4, "b": 2}, what="a division by 0",
        ...                 check_id="by_zero", title="A division by 0 is refused", points=1.0, proves=["by_zero"])
    """

    def talk(node: GradedNode) -> None:
        wanted = refused or {"success": False}
        for fields in drawn_values(requests, node.context.random):
            node.call(service, fields).refused(reason=reason, what=what, **wanted)
        if valid is not None:
            answer = node.call(service, valid)
            if not list(differences(wanted, answer.response)):
                answer.fail(
                    "Your service refused a valid request.", expected="no refusal", diagnosis="validation.overzealous"
                )

    return made(check_id, title, points, talk, after, proves)


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
            message = node.message(subscription, one)
            wanted = expect(message)
            try:
                node.send(subscription, message).expect(publisher, wanted, within_s=within_s)
            except Failed as failed:
                for got in list(node.inbox(publisher).messages)[-1:] if failed.diagnosis is None else ():
                    failed.diagnosis = _cause(node, only_field(got, wanted), got)
                raise
            node.expect_nothing(publisher, seconds=_AT_ONCE_S, why=once)
        node.expect_nothing(publisher, why=once)

    once = f"Publish once on {publisher} for each message."
    return made(check_id, title, points, talk, after, proves)


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
    return made(check_id, title, points, lambda node: node.expect_nothing(*topics, seconds=seconds), after, proves)


def topic_rate(  # noqa: PLR0913 - what an author may say of it
    topic: str,
    hz: float,
    *,
    check_id: str,
    title: str,
    points: float,
    proves: Sequence[str],
    after: Sequence[str] = (),
    off_by: float = 0.2,
) -> Check:
    """A check that messages come at a rate.

    Args:
        topic: its name.
        hz: messages in a second.
        check_id: its id.
        title: one line for the learner.
        points: what it is worth.
        proves: ids of the sentences of the task.
        after: ids of checks that have to pass before.
        off_by: the share of the period by which it may be off; a machine is now and then busy.

    Example:
        >>> topic_rate("/heartbeat", 10.0, check_id="rate", title="Ten a second", points=1.0, proves=["rate"])
    """

    def talk(node: GradedNode) -> Evidence:
        node.meet()
        inbox, period_s, clock = node.inbox(topic), 1.0 / hz, node.context.clock()
        found, count = 0.0, max(_FEWEST, inbox.count)
        expected = f"a message on {topic} every {period_s:.3g} s"
        while node.context.wait_until(lambda least=count: inbox.count >= least, max(_SILENT_S, 4 * period_s)):  # type: ignore[misc] # of none
            times = list(inbox.times)
            looks = (times, times[-max(_FEWEST + 1, len(times) // 2) :])  # all, and the last of them
            periods = [(some[-1] - some[0]) / (len(some) - 1) for some in looks]
            found, count = periods[0], inbox.count + 1
            if any(abs(one - period_s) <= off_by * period_s for one in periods):
                return Evidence("", expected, f"one every {found:.3g} s")
            if clock.past(10 * period_s + _SILENT_S):
                break
        why = f"Publish {topic} from a timer with a period of {period_s:.3g} s."
        if inbox.count < _FEWEST:
            raise Failed(Evidence("", expected, f"{inbox.count} messages"), why, "topic.silent")
        raise Failed(Evidence("", expected, f"one every {found:.3g} s"), why)

    return made(check_id, title, points, talk, after, proves)


def _cause(node: GradedNode, wanted: Any, got: Any) -> str | None:
    """The diagnosis of a wrong number: another formula, or // where the number is off by less than one."""
    for _, right, other in differences(wanted, got):
        one = right.value if isinstance(right, Close) else right
        if all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in (one, other)):
            near = node.context.job.facts.floor_divides and abs(one - other) < 1
            return "math.integer_division" if near else "math.formula"
    return None
