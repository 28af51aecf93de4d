"""Waits until a submission offers what its exercise names, and says what stands there instead when it does not."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

from rclpy.duration import Infinite
from rclpy.qos import LivelinessPolicy, QoSCompatibility, QoSProfile, qos_check_compatible

from course_kit.grading.checks import hangs
from course_kit.grading.checks.context import GRAPH_STEP_S, SubmissionEndedError
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.grader_node import DEPTH, ROLES
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
        return f"{ROLES[self.kind].verb} {self.name} [{self.type}]"

    def is_ready(self, node: GraderNode) -> bool:
        """Whether the grader's own end, made on first use, is connected with it."""
        if self.kind == "service":
            return node.client(self.interface, self.name).is_ready()
        if self.kind == "action":
            return node.action(self.interface, self.name).is_ready()
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
        return [kind for name, kind in node.offers(self.kind) if name == self.name]


def expect_endpoints(context: CheckContext, ends: Sequence[WantedEndpoint]) -> Evidence:
    """A program that was just started has these, each with its type, a default end connects, and it can be asked."""
    ends = sorted(ends, key=lambda end: (not end.is_server, end.kind))  # publishers before subscriptions
    expected = "; ".join(end.describe() for end in ends)
    node = context.grader_node

    def list_lacks() -> list[WantedEndpoint]:
        return [end for end in ends if not (end.is_ready(node) if end.is_server else end.type in end.types(node))]

    await_start(context, expected, lambda: not list_lacks())
    if list_lacks() and not node.nodes():
        context.spoil()
        raise Failed(Evidence("", expected, "on the graph: no node"), *why_empty(context, list_lacks()[0].name)[::-1])
    for end in ends:
        if not (end.is_server and end.is_ready(node)):
            _require_connection(context, end)
    try:
        hangs.greet_node(context)
    except SubmissionEndedError as ended:  # one that offers a service and ends at once is no server
        if ended.diagnosis == "start.exit":
            raise Failed(Evidence("", expected, ENDED), ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def await_start(context: CheckContext, expected: str, condition: Callable[[], bool]) -> None:
    """Wait until something holds of a program just started, or it has made all it will make, or its time is over."""
    clock = context.clock()
    with explain_end(context, Evidence("", expected), causes.explain_start, ENDED):
        context.wait_for_start(lambda: condition() or _has_settled(context, clock))


def _has_settled(context: CheckContext, clock: FairClock) -> bool:
    """Whether a node is up and spinning for so long, by a clock of the waiting, that it has made all it will make."""
    if not clock.has_passed(_SETTLED_S) or not context.grader_node.nodes():
        return False
    seen = context.memory.setdefault("seen", context.clock())  # a node is there a moment before what it offers
    if not seen.has_passed(_NODE_S / 2):
        return False
    return context.job.mode != "run" or hangs.current_activity(context).spinning  # an executor: it is all made


def expect_node(context: CheckContext, name: str) -> Evidence:
    """A node of this full name is on the graph of a program that runs."""
    expected = f"a node called {name}"
    with explain_end(context, Evidence("", expected), causes.explain_call, ENDED):
        found = context.wait_until(lambda: name in context.grader_node.nodes(), _NODE_S, step_s=GRAPH_STEP_S)
    if found:
        return Evidence("", expected, expected)
    raise explain_other_nodes(name, context.grader_node.nodes())


def first_node(context: CheckContext) -> str:
    """The full name of the program's only node, or of its first one by the alphabet."""
    if not context.wait_until(lambda: bool(context.grader_node.nodes()), _NODE_S, step_s=GRAPH_STEP_S):
        raise Failed(Evidence("", "a node", "no node is on the graph"), "Your program runs, but it has no node.")
    return context.grader_node.nodes()[0]


def explain_other_nodes(name: str, nodes: Sequence[str]) -> Failed:
    """There are nodes, but none of this full name."""
    evidence = Evidence("", f"a node called {name}", f"on the graph: {list_nodes(nodes)}")
    message = f"The graph has {list_nodes(nodes)}, but none is called {name}.{name_nearest(name, nodes)}"
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
    if not context.job.text.files:
        return "Your program worked when it was first started. Started again, it did not offer all of this.", None
    if logged := causes.explain_logged(context.program.status(fresh=True).stderr, context.job):
        return logged[::-1]
    return f"No node {ROLES[end.kind].verb} {end.name}, which is a task of {end.program}.", None


def list_nodes(names: Sequence[str]) -> str:
    """`the nodes /a, /b`, or `no node`; hidden ones, such as a notebook's own, do not count."""
    shown = [name for name in names if not is_hidden(name)]
    return f"the node{'s' if len(shown) > 1 else ''} {', '.join(shown)}" if shown else "no node"


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


def _require_connection(context: CheckContext, end: WantedEndpoint) -> None:
    """The program has it, with its type, and a default end of ours connects with it."""
    node, verb, expected = context.grader_node, ROLES[end.kind].verb, end.describe()
    types = end.types(node)
    if not types:
        offers = node.offers(end.kind)
        alike = [name for name, kind in offers if kind == end.type] or [name for name, _ in offers]
        message = f"No node {verb} {end.name}.{name_nearest(end.name, alike)}"
        diagnosis = "topic.silent" if not end.is_server else f"name.{end.kind}" if offers else None
        got = "; ".join(f"{name} [{kind}]" for name, kind in offers) or list_nodes(node.nodes())
        raise Failed(Evidence("", expected, f"on the graph: {got}"), message, diagnosis)
    if end.type not in types:
        evidence = Evidence("", expected, f"{verb} {end.name} [{types[0]}]")
        message = f"Your node {verb} {end.name} with type {types[0]}, expected {end.type}."
        raise Failed(evidence, message, "type.interface")
    if end.is_server:
        message = f"Your node {verb} {end.name} with the right type, but a client cannot connect to all of it."
        why = f"{message} Make it with the default QoS profile, and keep it as long as the node."
        raise Failed(Evidence("", expected, "a part of it"), why)
    profiles = [other.qos_profile for other in node.ends(end.kind, end.name) if other.topic_type == end.type]
    reasons = [_explain_mismatch(profile, publishes=end.kind == "publisher") for profile in profiles]
    if profiles and all(reasons):
        given = f"{profiles[0].reliability.name.lower()}, {profiles[0].durability.name.lower()}"
        evidence = Evidence("", expected, f"{verb} {end.name} with the QoS {given}")
        message = f"Your end is {given}, the other one reliable, volatile: they do not connect."
        raise Failed(evidence, f"{message} The middleware says: {reasons[0]}", "topic.qos")


def _explain_mismatch(qos: QoSProfile, *, publishes: bool) -> str:
    """Why an endpoint with the default profile at the other end does not connect; nothing when it does."""
    compatibility, reason = qos_check_compatible(*((qos, _DEFAULT) if publishes else (_DEFAULT, qos)))
    return str(reason) or "incompatible" if compatibility == QoSCompatibility.ERROR else ""
