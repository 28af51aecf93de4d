"""Ready-made checks: functions that return a check. What they look at is named in exercise.toml, `[[endpoints]]`.

Each takes its declaration, the fields of `CheckFields`, as keywords.
"""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any, TypedDict

from course_kit.grading.checks import discovery
from course_kit.grading.checks.answers import UNFILLED, Approximation, are_same, describe_value, differences, only_field
from course_kit.grading.checks.check import Check
from course_kit.grading.checks.context import ANSWER_S
from course_kit.grading.checks.evidence import Evidence, Failed, in_one_line
from course_kit.grading.checks.graded_node import MESSAGE_S, GradedNode
from course_kit.grading.checks.steps import draw_values

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from typing_extensions import Required, Unpack

    from course_kit.grading.checks.context import CheckContext

DEADLINE_S = 12.0
_AT_ONCE_S = 0.05  # in which a second message of the same callback comes
_FEWEST = 3  # messages; enough to forget one that a busy machine has delayed
_SILENT_S = 2.0
_EFFECT_S = 0.2  # rclpy may tell the callbacks of a change after it has answered


class CheckFields(TypedDict, total=False):
    """What a check is declared with.

    Attributes:
        check_id: its id; that of `check` is the function's name.
        title: one line for the learner; that of `check` is the first line of the docstring.
        points: what it is worth.
        proves: ids of the sentences of the exercise that it proves.
        after: ids of checks without which it makes no sense: it is skipped unless they passed.
        deadline_s: seconds for all its waiting together.
        begin: what is done with the node first, where several checks begin alike.
    """

    check_id: str
    title: str
    points: Required[float]
    proves: Sequence[str]
    after: Sequence[str]
    deadline_s: float
    begin: Callable[[GradedNode], object]


def check(**declared: Unpack[CheckFields]) -> Callable[[Callable[[GradedNode], object]], Check]:
    """Decorator that makes a function a check: it talks with a node, and passes when nothing it expects fails.

    The function's name is the check's id, the first line of its docstring what a learner reads.

    Args:
        declared: see `CheckFields`.

    Raises:
        ValueError: the function has no docstring, or is worth nothing.

    Example:
        >>> @check(points=1.5, after=["offered"], proves=["reset"])
        ... def reset_is_refused(node):
        ...     "While it is critical, a reset is refused."
        ...     node.send("/voltage", 9.0).expect("/state", "critical")
        ...     node.call("/reset").refused()
    """

    def declare(talk: Callable[[GradedNode], object]) -> Check:
        title = (inspect.getdoc(talk) or "").partition("\n")[0].rstrip(".")
        fields: CheckFields = {"check_id": talk.__name__, "title": title, **declared}
        return make_check(talk, **fields)

    return declare


def make_check(
    talk: Callable[[GradedNode], object], usual_s: float = DEADLINE_S, /, **declared: Unpack[CheckFields]
) -> Check:
    """A check of what a function does with a node; see `check`."""
    check_id, title, points = declared["check_id"], declared["title"], declared["points"]
    if not title:
        raise ValueError(f"the check {check_id} needs a docstring: its first line is shown as the title")
    if points <= 0:
        raise ValueError(f"the check {check_id} needs points above 0")

    def run(context: CheckContext) -> Evidence:
        node = GradedNode(context)
        try:
            if begin := declared.get("begin"):
                begin(node)
            seen = talk(node)
        except Failed:
            context.spoil()  # for the state that may be left behind
            raise
        if isinstance(seen, Evidence):
            return seen
        sent, got = context.record.last_exchange()
        return Evidence(sent, title, got)

    after, deadline_s = tuple(declared.get("after", ())), declared.get("deadline_s", usual_s)
    return Check(check_id, title, float(points), after, deadline_s, run, tuple(declared.get("proves", ())))


def endpoints_offered(*names: str, **declared: Unpack[CheckFields]) -> Check:
    """A check that the program offers the endpoints of exercise.toml, each with its type, and a default one connects.

    Args:
        names: some of the endpoints; all of them when none is named.
        declared: see `CheckFields`; its id is `offered` unless another one is given.

    Example:
        >>> endpoints_offered(points=1.0, proves=["topics"], title="Both topics are there")
    """

    @check(**declared)
    def offered(node: GradedNode) -> Evidence:
        """All of its endpoints are there, with their types."""
        node.prepare()
        ends = [end for end in node.endpoints if not names or end.name in names]
        return discovery.expect_endpoints(node.context, ends)

    return offered


def node_name(name: str, **declared: Unpack[CheckFields]) -> Check:
    """A check that the node has its name, given without a slash; declared with `CheckFields`.

    Example:
        >>> node_name("battery_monitor", points=0.5, proves=["node"], after=["offered"])
    """

    def talk(node: GradedNode) -> Evidence:
        node.ensure_running()
        return discovery.expect_node(node.context, f"/{name}")

    fields: CheckFields = {"check_id": "node_name", "title": f"The node is called {name}", **declared}
    return make_check(talk, **fields)


def service_answers(  # noqa: PLR0913 - what an author may say of it
    service: str,
    requests: Sequence[dict[str, Any]],
    expect: Callable[[Any], dict[str, Any]],
    *,
    within_s: float = ANSWER_S,
    not_before_s: float = 0.0,
    at_a_time: int = 0,
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that a service answers some requests.

    Args:
        service: its name.
        requests: fields of each; a value may be a drawing, such as `draw_between(1, 99)`.
        expect: gives the fields of the right response for a request.
        within_s: seconds in which an answer comes; with `at_a_time`, in which all do.
        not_before_s: seconds before which none comes, where the work takes its time.
        at_a_time: ask so many at the same time; one after the other when 0.
        declared: see `CheckFields`.

    Example:
        >>> service_answers("/add", [{"a": 1, "b": draw_between(-9, 9)}] * 3, lambda asked: {"sum": asked.a + asked.b},
        ...                 check_id="sum", title="/add answers with the sum", points=1.0, proves=["sum"])
    """

    def talk(node: GradedNode) -> None:
        several = draw_values(requests, node.context.random)
        wanted = [expect(node.message_for(service, fields)) for fields in several]
        if at_a_time:
            answers = node.call_together(service, several, at_a_time=at_a_time, within_s=within_s)
        else:
            answers = [node.call(service, fields, within_s=max(within_s, ANSWER_S)) for fields in several]
        for answer, fields in zip(answers, wanted, strict=True):
            if not at_a_time:
                answer.not_before(not_before_s)
                answer.within(within_s)
            code, why = _cause(node, fields, answer.response), ""
            if answer.response == type(answer.response)():
                code, why = None, UNFILLED
            if at_a_time and any(are_same(other, answer.response) for other in wanted):
                code = None
                why = "Your node sent the answer to another request: your callback mixes up values of two calls."
            answer.expect(**fields, diagnosis=code, why=why)

    return make_check(talk, **declared)


def service_refuses(  # noqa: PLR0913 - what an author may say of it
    service: str,
    requests: Sequence[dict[str, Any]],
    *,
    refused: dict[str, Any] | None = None,
    reason: str = "message",
    what: str = "a request that it has to refuse",
    valid: dict[str, Any] | None = None,
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that a service refuses some requests, says why, and lives on.

    Args:
        service: its name.
        requests: fields of each; a value may be a drawing.
        refused: the fields by which a refusal is known; `success=False` when left out.
        reason: the field that says why, "" where the exercise asks for no reason.
        what: is wrong with these requests, for the learner.
        valid: a request that is asked afterwards, and must not be refused.
        declared: see `CheckFields`.

    Example:
        >>> service_refuses("/divide", [{"a": draw_between(1, 9), "b": 0}], valid={"a": 4, "b": 2},
        ...                 what="a division by 0", check_id="by_zero", title="A division by 0 is refused",
        ...                 points=1.0, proves=["by_zero"])
    """

    def talk(node: GradedNode) -> None:
        wanted = refused or {"success": False}
        for fields in draw_values(requests, node.context.random):
            node.call(service, fields).refused(reason=reason, what=what, **wanted)
        if valid is not None:
            answer = node.call(service, valid)
            if are_same(wanted, answer.response):
                why = "Your service refused a valid request."
                answer.fail(why, expected="no refusal", diagnosis="validation.overzealous")

    return make_check(talk, **declared)


def topic_answers(
    subscription: str,
    publisher: str,
    messages: Sequence[Any],
    expect: Callable[[Any], Any],
    *,
    within_s: float = MESSAGE_S,
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that each message on one topic is answered by exactly one on another.

    Args:
        subscription: the topic of the messages that are sent.
        publisher: the topic of the answers.
        messages: what is sent: a value of the only field, a dict, or a drawing.
        expect: gives what a right answer is for a message.
        within_s: seconds in which the answer comes.
        declared: see `CheckFields`.

    Example:
        >>> topic_answers("/brightness", "/lamp", [0.5, 0.500001, draw_between(0.0, 0.499)], lambda m: m.data > 0.5,
        ...               check_id="switches", title="The lamp is on above 0.5", points=1.0, proves=["threshold"])
    """

    def talk(node: GradedNode) -> None:
        for given in draw_values(messages, node.context.random):
            message = node.message_for(subscription, given)
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
    return make_check(talk, **declared)


def topic_silent(*topics: str, seconds: float = 1.0, **declared: Unpack[CheckFields]) -> Check:
    """A check that nothing comes on some topics while nothing is sent.

    Args:
        topics: their names.
        seconds: for how long.
        declared: see `CheckFields`.

    Example:
        >>> topic_silent("/alarm", check_id="quiet", title="No alarm without a cause", points=1.0, proves=["quiet"])
    """
    return make_check(lambda node: node.expect_nothing(*topics, seconds=seconds), **declared)


def topic_rate(topic: str, hz: float, *, off_by: float = 0.2, **declared: Unpack[CheckFields]) -> Check:
    """A check that messages come at a rate.

    Args:
        topic: its name.
        hz: messages in a second.
        off_by: the share of the period by which it may be off; a machine is now and then busy.
        declared: see `CheckFields`.

    Example:
        >>> topic_rate("/heartbeat", 10.0, check_id="rate", title="Ten a second", points=1.0, proves=["rate"])
    """
    period_s = 1.0 / hz
    bounds = (1.0 - off_by) * period_s, (1.0 + off_by) * period_s
    return make_check(lambda node: expect_rate(node, topic, period_s, bounds), **declared)


def expect_rate(
    node: GradedNode, topic: str, period_s: float, bounds: tuple[float, float], act: Callable[[], object] | None = None
) -> Evidence:
    """Messages come on a topic, on average with a period between these bounds, while something else is done, too."""
    node.ensure_running()
    inbox, clock, wait_s = node.inbox(topic), node.context.clock(), max(_SILENT_S, 4 * period_s)
    found, count = 0.0, max(_FEWEST, inbox.count)

    def has_come(least: int) -> bool:
        before, look_s = node.context.clock(), period_s / 2 if act else wait_s
        while not node.context.wait_until(lambda: inbox.count >= least, look_s):
            if act is None or before.has_passed(wait_s):
                return False
            act()
        return True

    expected = f"a message on {topic} every {bounds[0]:.3g} to {bounds[1]:.3g} s, on average"
    while has_come(count):
        times = list(inbox.times)
        looks = (times, times[-max(_FEWEST + 1, len(times) // 2) :])  # all, and the last of them
        periods = [(some[-1] - some[0]) / (len(some) - 1) for some in looks]
        found, count = periods[0], inbox.count + 1
        if any(bounds[0] <= period <= bounds[1] for period in periods):
            return Evidence("", expected, f"one message every {found:.3g} s")
        if clock.has_passed(10 * period_s + _SILENT_S):
            break
    why = f"Publish {topic} from a timer with a period of {period_s:.3g} s."
    if inbox.count < _FEWEST:
        raise Failed(Evidence("", expected, f"messages: {inbox.count}"), why, "topic.silent")
    raise Failed(Evidence("", expected, f"one message every {found:.3g} s"), why)


def parameter_declared(defaults: dict[str, Any], *, node: str, **declared: Unpack[CheckFields]) -> Check:
    """A check that a node has parameters, with these values at the start, and so with their types.

    Args:
        defaults: by the parameters' names.
        node: its full name.
        declared: see `CheckFields`.

    Example:
        >>> parameter_declared({"max_speed": 1.0}, node="/speed_limiter", check_id="declared",
        ...                    title="max_speed is 1.0 at the start", points=1.0, proves=["parameter"])
    """

    def talk(graded: GradedNode) -> Evidence:
        graded.ensure_running()
        return graded.parameters(node).expect_declared(defaults)

    return make_check(talk, **declared)


def parameter_acts(
    settings: Sequence[dict[str, Any]],
    subscription: str,
    publisher: str,
    messages: Sequence[Any],
    expect: Callable[[Any, dict[str, Any]], Any],
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that parameters which are set change what a node answers. Afterwards they are what they were.

    Args:
        settings: values by the parameters' names, tried one after the other; a value may be a drawing.
        subscription: the topic of the messages that are sent.
        publisher: the topic of the answers.
        messages: what is sent, before and after each change.
        expect: gives what a right answer is for a message and a setting.
        declared: see `CheckFields`.

    Example:
        >>> parameter_acts([{"max_speed": 0.5}, {"max_speed": 2.0}], "/speed_in", "/speed", [3.0, 0.25],
        ...                lambda message, setting: min(message.data, setting["max_speed"]),
        ...                check_id="change", title="A change acts", points=1.0, proves=["change"])
    """

    def answers(node: GradedNode, sent: Sequence[Any]) -> list[Any]:
        return [node.send(subscription, message).expect(publisher) for message in sent]

    def talk(node: GradedNode) -> None:
        sent = [node.message_for(subscription, given) for given in draw_values(messages, node.context.random)]
        for setting in draw_values(settings, node.context.random):
            before, old = node.get(*setting), answers(node, sent)
            node.set(setting).accepted()
            node.wait(_EFFECT_S)
            new = answers(node, sent)
            for message, got in zip(sent, new, strict=True):
                wanted = only_field(got, expect(message, setting))
                if are_same(wanted, got):
                    continue
                why, code = f"Expected {describe_value(wanted)} with the new setting.", "math.formula"
                if new == old:
                    why = "Your node accepted the change, but the output is the same as before."
                    code = "parameter.read_once"
                text = f"set {describe_value(setting)}; {subscription}: {in_one_line(message)}"
                raise Failed(Evidence(text, describe_value(wanted), in_one_line(got)), why, code)
            node.set(before).accepted()

    return make_check(talk, **declared)


def parameter_refuses(
    settings: Sequence[dict[str, Any]], *, reason: Sequence[str] = (), **declared: Unpack[CheckFields]
) -> Check:
    """A check that a node refuses changes of parameters with a reason, and that their values stay.

    A value of another type, and a parameter that is not declared, need no reason: rclpy gives its own.

    Args:
        settings: values by the parameters' names; several in one are set at once, all or none.
        reason: words that the reason has to contain; any reason will do when there are none.
        declared: see `CheckFields`.

    Example:
        >>> parameter_refuses([{"max_speed": -1.0}, {"max_speed": 0.5, "name": ""}], reason=["max_speed"],
        ...                   check_id="range", title="A negative max_speed is refused", points=1.0, proves=["range"])
    """

    def talk(node: GradedNode) -> None:
        for setting in draw_values(settings, node.context.random):
            before = node.get(*setting)
            alike = all(type(value) is type(before[name]) for name, value in setting.items())
            code = "parameter.undeclared" if None in before.values() else "parameter.type"
            change = node.set(setting)
            change.refused(diagnosis="validation.missing" if alike else code)
            reason_given = change.result.reason
            if alike and (not reason_given.strip() or any(word not in reason_given for word in reason)):
                expected = f"refused, with a reason{' that names ' + ' and '.join(reason) if reason else ''}"
                why = "Your node was right to refuse, but the reason has to say why."
                change.fail(why, expected=expected, diagnosis="validation.no_reason")
            if node.get(*setting) != before:
                why = "The parameter has changed although the change was refused."
                change.fail(why, expected="refused, and nothing changes", diagnosis="parameter.not_atomic")

    return make_check(talk, **declared)


def _cause(node: GradedNode, wanted: Any, got: Any) -> str | None:
    """The diagnosis of a wrong number: another formula, or // where the number is off by less than one."""
    for _, right, other in differences(wanted, got):
        expected = right.value if isinstance(right, Approximation) else right
        if all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in (expected, other)):
            near = node.context.job.text.facts.floor_divides and abs(expected - other) < 1
            return "math.integer_division" if near else "math.formula"
    return None
