"""Waits until a submission offers what its exercise names, and says what stands there instead when it does not."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

from rclpy.duration import Infinite
from rclpy.qos import LivelinessPolicy, QoSCompatibility, QoSProfile, qos_check_compatible

from course_kit.grading.checks import hangs
from course_kit.grading.checks.context import GRAPH_STEP_S, SubmissionEndedError
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.grader_node import DEPTH, ActionChannels
from course_kit.grading.checks.hangs import explain_end
from course_kit.grading.diagnosis import causes
from course_kit.grading.model.job import ExerciseEndpoint
from course_kit.interfaces import get_type
from course_kit.ros.names import is_hidden, nearest_name

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.fair_clock import FairClock
    from course_kit.grading.checks.grader_node import GraderNode

ENDED = "a program that has ended"
_SETTLED_S = 2.0  # a node that is up and spinning for so long has made the servers it will make
_NODE_S = 1.5  # a node's name arrives a moment after its endpoints
_MOST = 200  # names that are compared
_get_type = lru_cache(get_type)
_VERBS = {"publisher": "publishes", "subscription": "subscribes to"}
# The default profile as the graph reports it: with its unlimited times written out.
_DEFAULT = QoSProfile(
    depth=DEPTH,
    liveliness=LivelinessPolicy.AUTOMATIC,
    deadline=Infinite,
    lifespan=Infinite,
    liveliness_lease_duration=Infinite,
)


class WantedEndpoint(ExerciseEndpoint):
    """One of them."""

    @property
    def interface(self) -> Any:
        """The class of its interface."""
        return _get_type(self.type)

    @property
    def is_server(self) -> bool:
        """Whether it is a service or an action, not the end of a topic."""
        return self.kind in ("service", "action")

    def describe(self) -> str:
        """In words, for a learner."""
        if self.is_server:
            return f"the {self.kind} {self.name} of type {self.type}"
        return f"{_VERBS[self.kind]} {self.name} [{self.type}]"

    def is_ready(self, node: GraderNode) -> bool:
        """Whether the grader's own end, made on first use, is connected with it."""
        if self.kind == "service":
            return node.client(self.interface, self.name).is_ready()
        if self.kind == "action":
            return ActionChannels(node, self.name, self.interface).is_ready()
        if self.kind == "publisher":
            node.inbox(self.interface, self.name)
            return bool(node.ends(self.kind, self.name))
        return bool(node.publisher(self.interface, self.name).get_subscription_count())

    def is_there(self, context: CheckContext) -> bool:
        """Whether the program has it; where several run, who listens to a topic hears nothing of ours unasked."""
        if self.kind == "subscription" and context.job.launches:
            return bool(context.grader_node.ends(self.kind, self.name))
        return self.is_ready(context.grader_node)

    def types(self, node: GraderNode) -> list[str]:
        """The types with which the name is there."""
        if self.is_server:
            return [kind for name, kind in node.offers(self.kind) if name == self.name]
        return [end.topic_type for end in node.ends(self.kind, self.name)]


def expect_endpoints(context: CheckContext, ends: Sequence[WantedEndpoint]) -> Evidence:
    """A program that was just started has these, each with its type, a default end connects, and it can be asked."""
    ends = sorted(ends, key=lambda end: (not end.is_server, end.kind))  # publishers before subscriptions
    expected = "; ".join(end.describe() for end in ends)
    node, clock = context.grader_node, context.clock()

    def list_lacks() -> list[WantedEndpoint]:
        return [end for end in ends if not (end.is_ready(node) if end.is_server else end.type in end.types(node))]

    with explain_end(context, Evidence("", expected), causes.explain_start, ENDED):
        context.wait_for_start(lambda: not list_lacks() or has_settled(context, clock))
    if list_lacks() and not node.nodes():
        context.spoil()
        raise Failed(Evidence("", expected, "on the graph: no node"), *why_empty(context, list_lacks()[0].name)[::-1])
    for end in ends:
        if not end.is_server:
            _require_topic(context, end)
        elif not end.is_ready(node):
            raise _not_offered(context, end)
    try:
        hangs.greet_node(context)
    except SubmissionEndedError as ended:  # one that offers a service and ends at once is no server
        if ended.diagnosis == "start.exit":
            raise Failed(Evidence("", expected, ENDED), ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def has_settled(context: CheckContext, clock: FairClock) -> bool:
    """Whether a node is up and spinning for so long, by a clock of the waiting, that it has made all it will make."""
    if not clock.has_passed(_SETTLED_S) or not context.grader_node.nodes():
        return False
    seen = context.memory.setdefault("seen", context.clock())  # a node is there a moment before what it offers
    if not seen.has_passed(_NODE_S / 2):
        return False
    return context.job.mode != "run" or hangs.current_activity(context).spinning  # an executor: it is all made


def expect_node(context: CheckContext, name: str, ensure: Callable[[], None]) -> Evidence:
    """A node of this full name is on the graph, after `ensure` has had the program running."""
    expected = f"a node called {name}"
    with explain_end(context, Evidence("", expected), causes.explain_call, ENDED):
        ensure()
        found = context.wait_until(lambda: name in context.grader_node.nodes(), _NODE_S, step_s=GRAPH_STEP_S)
    if found:
        return Evidence("", expected, expected)
    nodes = context.grader_node.nodes()
    raise explain_other_nodes(name, nodes, Evidence("", expected, f"on the graph: {', '.join(nodes) or 'no node'}"))


def first_node(context: CheckContext) -> str:
    """The full name of the program's only node, or of its first one by the alphabet."""
    if not context.wait_until(lambda: bool(context.grader_node.nodes()), _NODE_S, step_s=GRAPH_STEP_S):
        raise Failed(Evidence("", "a node", "no node is on the graph"), "Your program runs, but it has no node.")
    return context.grader_node.nodes()[0]


def explain_other_nodes(name: str, nodes: Sequence[str], evidence: Evidence) -> Failed:
    """There are nodes, but none of this full name."""
    message = f"The graph has {list_names(nodes, 'node')}, but none is called {name}.{name_nearest(name, nodes)}"
    return Failed(evidence, message, "name.node")


def why_empty(context: CheckContext, wanted: str) -> causes.Cause:
    """Why no node has appeared, although the program runs."""
    if context.job.mode == "attach":
        domain = context.grader_node.node.context.get_domain_id()
        return "start.nothing", f"No node on ROS domain {domain} offers {wanted}."
    doing = hangs.current_activity(context)
    where = f" Your program stays in {causes.source_line(context.job, doing.own)}." if doing.own else ""
    if context.has_computed_enough():
        computed = f"Your program has computed for {context.job.start_cpu_s:g} s"
        return "limit.time", f"{computed} and no node has appeared.{where}"
    start = f"{min(context.job.limits.start_s, context.deadline_s):g} s"
    if hangs.is_computing(context):
        return "limit.time", f"After {start} your program was still computing and no node had appeared.{where}"
    return "start.nothing", f"Your program runs, but no node appeared on the graph within {start}.{where}"


def name_nearest(wanted: str, names: Sequence[str]) -> str:
    """A sentence that names what is written most like `wanted`, with a space before it; nothing if nothing is."""
    near = nearest_name(wanted, names[:_MOST])
    return f" The closest is {near}." if near else ""


def explain_missing(context: CheckContext, end: WantedEndpoint) -> tuple[str, str | None]:
    """Why an end is not there of a program that runs: in words, and its diagnosis."""
    if not context.job.files:
        return "Your program worked when it was first started. Started again, it did not offer all of this.", None
    if logged := causes.explain_logged(context.program.status(fresh=True).stderr, context.job):
        return logged[::-1]
    verb = {"publisher": "publish", "subscription": "subscribe to"}.get(end.kind, f"offer the {end.kind}")
    return f"{end.program} has to {verb} {end.name}, but no node does.", None


def list_names(names: Sequence[str], what: str) -> str:
    """`the nodes /a, /b`, or `no node`."""
    return f"the {what}{'s' if len(names) > 1 else ''} {', '.join(names)}" if names else f"no {what}"


def explain_silent_topic(context: CheckContext, sent: str, missing: str, seconds: str) -> causes.Cause:
    """Why nothing came on the topic `missing` within some seconds, after one on the topic `sent` if that is named."""
    seen = hangs.current_activity(context)
    if seen.callback is not None:
        context.spoil()
        where = causes.source_line(context.job, seen.callback)
        if hangs.is_computing(context):
            return "limit.time", f"Your callback was still computing in {where} after {seconds} s."
        return None, f"Your callback is blocked in {where}; meanwhile nothing is published."
    if logged := causes.explain_logged(context.program.status(fresh=True).stderr, context.job):
        context.spoil()
        return logged
    received = f"received a message on {sent} but " if sent else ""
    return "topic.silent", f"Your node {received}published nothing on {missing} within {seconds} s."


def _not_offered(context: CheckContext, wanted: WantedEndpoint) -> Failed:
    offers, types = context.grader_node.offers(wanted.kind), wanted.types(context.grader_node)
    nodes = context.grader_node.nodes()
    context.spoil()
    got = "; ".join(f"{name} [{kind}]" for name, kind in offers) or list_names(nodes, "node")
    evidence = Evidence("", wanted.describe(), f"on the graph: {got}")
    if wanted.type in types:
        message = f"{wanted.kind} {wanted.name} exists with the right type, but a client cannot connect to all of it."
        return Failed(evidence, f"The {message} Make it with the default QoS profile, and keep it as long as the node.")
    if types:
        message = f"The {wanted.kind} {wanted.name} has type {types[0]}, expected {wanted.type}."
        return Failed(evidence, message, "type.interface")
    if offers:
        alike = [name for name, kind in offers if kind == wanted.type] or [name for name, _ in offers]
        message = f"No {wanted.kind} is called {wanted.name}.{name_nearest(wanted.name, alike)}"
        return Failed(evidence, message, f"name.{wanted.kind}")
    return Failed(evidence, f"Your node {nodes[0]} is running, but it offers no {wanted.kind}.", None)


def _require_topic(context: CheckContext, end: WantedEndpoint) -> None:
    verb, found, expected = _VERBS[end.kind], context.grader_node.ends(end.kind, end.name), end.describe()
    fitting = [end_there for end_there in found if end_there.topic_type == end.type]
    if not found:
        others = [topic for topic in context.grader_node.topics() if not is_hidden(topic)]
        message = f"No node {verb} {end.name}.{name_nearest(end.name, others)}"
        evidence = Evidence("", expected, f"on the graph: {list_names(others, 'topic')}")
        raise Failed(evidence, message, "topic.silent")
    if not fitting:
        evidence = Evidence("", expected, f"{verb} {end.name} [{found[0].topic_type}]")
        message = f"Your node {verb} {end.name} with type {found[0].topic_type}, expected {end.type}."
        raise Failed(evidence, message, "type.interface")
    reasons = [_mismatch(end_there.qos_profile, publishes=end.kind == "publisher") for end_there in fitting]
    if all(reasons):
        given = _policies(fitting[0].qos_profile)
        evidence = Evidence("", expected, f"{verb} {end.name} with the QoS {given}")
        message = f"Your end is {given}, the other one {_policies(_DEFAULT)}: they do not connect."
        raise Failed(evidence, f"{message} The middleware says: {reasons[0]}", "topic.qos")


def _mismatch(qos: QoSProfile, *, publishes: bool) -> str:
    """Why an endpoint with the default profile at the other end does not connect; nothing when it does."""
    compatibility, reason = qos_check_compatible(*((qos, _DEFAULT) if publishes else (_DEFAULT, qos)))
    return str(reason) or "incompatible" if compatibility == QoSCompatibility.ERROR else ""


def _policies(qos: QoSProfile) -> str:
    return f"{qos.reliability.name.lower()}, {qos.durability.name.lower()}"
