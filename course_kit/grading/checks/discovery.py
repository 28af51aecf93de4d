"""Waits until a submission offers what its exercise names, and says what stands there instead when it does not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rcl_interfaces.srv import ListParameters
from rclpy.duration import Infinite
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)

from course_kit.grading.checks import hangs
from course_kit.grading.checks.actions import ActionChannels
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import GRAPH_STEP_S
from course_kit.grading.checks.graded_program import SubmissionEndedError
from course_kit.grading.checks.grader_node import DEPTH
from course_kit.grading.checks.hangs import explained
from course_kit.grading.diagnosis import exceptions, exits
from course_kit.interfaces import get_type
from course_kit.ros.messages import type_name
from course_kit.ros.names import nearest_name
from course_kit.ros.parameters import LIST_SERVICE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.fair_clock import FairClock
    from course_kit.grading.checks.grader_node import GraderNode, Offer
    from course_kit.grading.model.plain_data import Record
    from course_kit.ros import topic
    from course_kit.ros.messages import Message
    from course_kit.ros.service import ServiceClient

ENDED = "a program that has ended"
_SETTLED_S = 2.0  # a node that is up and spinning for so long has made the servers it will make
_GREET_S = 1.0
_ASK_AGAIN_S = 0.5
RESEND_AFTER_S = 1.0  # what has not been answered for so long is sent again
_NODE_S = 1.5  # a node's name arrives a moment after its endpoints
_OTHER_TYPE_S = 0.5  # the right name with another type: the node was seen to offer just that
_GRAPH_S = 2.0  # how long an end of a topic is waited for, of a node that is up
_MOST = 200  # names that are compared
_VAGUELY = 0.3  # how alike two names are at least: whatever there is beside what was looked for is of interest
_MOST_LISTED = 20
_VERBS = {"publisher": "publishes", "subscription": "subscribes to"}
# The default profile as the graph reports it: with its unlimited times written out.
_DEFAULT = QoSProfile(
    depth=DEPTH,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
    liveliness=LivelinessPolicy.AUTOMATIC,
    deadline=Infinite,
    lifespan=Infinite,
    liveliness_lease_duration=Infinite,
)


@dataclass(frozen=True)
class WantedEndpoint:
    """One of them."""

    kind: str  # what the program has: "service", "action", "publisher" or "subscription"
    name: str  # its full name
    interface: Any  # its class
    program: str = ""  # the file whose node has it, of several programs

    @classmethod
    def from_record(cls, record: Record) -> WantedEndpoint:
        """As exercise.toml names it."""
        return cls(record["kind"], record["name"], get_type(record["type"]), record.get("program", ""))

    @property
    def type(self) -> str:
        """The interface's name, `package/srv/Name`."""
        return type_name(self.interface)

    @property
    def is_server(self) -> bool:
        """Whether it is a service or an action, not the end of a topic."""
        return self.kind in ("service", "action")

    def is_ready(self, node: GraderNode) -> bool:
        """Whether the grader's own end, made on first use, is connected with it."""
        if self.kind == "service":
            return node.client(self.interface, self.name).is_ready()
        if self.kind == "action":
            return ActionChannels(node, self.name, self.interface).ready()
        if self.kind == "publisher":
            node.inbox(self.interface, self.name)
            return bool(node.publishers(self.name))
        return bool(node.publisher(self.interface, self.name).get_subscription_count())

    def is_there(self, context: CheckContext) -> bool:
        """Whether the program has it; where several run, who listens to a topic hears nothing of ours unasked."""
        if self.kind == "subscription" and context.job.launches:
            return bool(context.grader_node.subscriptions(self.name))
        return self.is_ready(context.grader_node)

    def offers(self, node: GraderNode) -> list[Offer]:
        """All servers of this kind on the graph."""
        return node.services() if self.kind == "service" else node.actions()


def expect_server(context: CheckContext, server: WantedEndpoint) -> Evidence:
    """A service or an action is on the graph, with its type, and its program is there to be asked."""
    # Its program has to be there to be asked, too: one that offers a service and ends at once is no server.
    expected = f"the {server.kind} {server.name} of type {server.type}"
    node, clock = context.grader_node, context.clock()

    def has_other_type() -> bool:
        return clock.wall() > _OTHER_TYPE_S and any(
            offer.name == server.name and offer.type != server.type for offer in server.offers(node)
        )

    with explained(context, Evidence("", expected), exits.of_start, ENDED):
        context.wait_for_start(lambda: server.is_ready(node) or has_other_type() or has_settled(context, clock))
    if not server.is_ready(node):
        raise _not_offered(context, server, expected)
    try:
        greet(context)
    except SubmissionEndedError as ended:
        if ended.diagnosis == "start.exit":
            raise Failed(Evidence("", expected, ENDED), ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def expect_topics(context: CheckContext, ends: Sequence[WantedEndpoint]) -> Evidence:
    """A program that was just started publishes and subscribes to these, and a default reliable endpoint connects."""
    clock, node = context.clock(), context.grader_node
    evidence = Evidence("", f"a node with {ends[0].name}")

    def is_there() -> bool:
        return all(_found(context, end) for end in ends)

    with explained(context, evidence, exceptions.of_start, ENDED):
        context.wait_for_start(lambda: is_there() or has_settled(context, clock))
    if not is_there() and not node.nodes():
        context.spoil()
        empty = Evidence("", evidence.expected, "on the graph: no node")
        raise Failed(empty, *why_empty(context, ends[0].name)[::-1])
    ordered = sorted(ends, key=lambda end: end.kind)  # publishers first
    expected = "; ".join(f"{_VERBS[end.kind]} {end.name} [{end.type}]" for end in ordered)
    with explained(context, Evidence("", expected)):
        context.wait_until(lambda: all(_fitting(context, end) for end in ends), _GRAPH_S, step_s=GRAPH_STEP_S)
    for end in ordered:
        _require_topic(context, end, expected)
    return Evidence("", expected, expected)


def has_settled(context: CheckContext, clock: FairClock) -> bool:
    """Whether a node is up and spinning for so long, by a clock of the waiting, that it has made all it will make."""
    if not clock.past(_SETTLED_S) or not context.grader_node.nodes():
        return False
    seen = context.memory.setdefault("seen", context.clock())  # a node is there a moment before what it offers
    return bool(seen.past(_NODE_S / 2)) and hangs.spins(context)


def expect_node(context: CheckContext, name: str, ensure: Callable[[], None]) -> Evidence:
    """A node of this full name is on the graph, after `ensure` has had the program running."""
    expected = f"a node called {name}"
    with explained(context, Evidence("", expected), exits.of_call, ENDED):
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


def why_empty(context: CheckContext, wanted: str) -> exits.Cause:
    """Why no node has appeared, although the program runs."""
    if context.job.mode == "attach":
        return "start.nothing", f"No node on ROS domain {context.grader_node.domain} offers {wanted}."
    doing = hangs.doing(context)
    where = f" It is in {exits.source_line(context.job, doing.own)}." if doing.own else ""
    if context.has_computed_enough():
        computed = f"Your program has computed for {context.job.start_cpu_s:g} s"
        return "limit.time", f"{computed} and no node has appeared.{where}"
    start = f"{min(context.job.limits.start_s, context.deadline_s):g} s"
    if hangs.computes(context):
        return "limit.time", f"After {start} your program was still computing and no node had appeared.{where}"
    return "start.nothing", f"Your program runs, but no node appeared on the graph within {start}.{where}"


def name_nearest(wanted: str, names: Sequence[str]) -> str:
    """A sentence that names what comes nearest to `wanted`, with a space before it; nothing without names."""
    near = nearest_name(wanted, names[:_MOST], _VAGUELY) or next(iter(names), "")
    return f" The closest is {near}." if near else ""


def explain_missing(context: CheckContext, end: WantedEndpoint) -> tuple[str, str | None]:
    """Why an end is not there of a program that runs: in words, and its diagnosis."""
    if not context.job.files:
        return "Your program started once, but did not offer all of this when it was started again.", None
    if logged := exceptions.of_logged(context.program.status(fresh=True).stderr, context.job):
        return logged[::-1]
    verb = _VERBS.get(end.kind, f"offers the {end.kind}")
    return f"No node {verb} {end.name}, which {end.program} has to bring.", None


def list_names(names: Sequence[str], what: str) -> str:
    """`the nodes /a, /b`, or `no node`; of very many the first."""
    some = ", ".join(names[:_MOST_LISTED])
    if len(names) > _MOST_LISTED:
        some += f" and {len(names) - _MOST_LISTED} more"
    return f"the {what}{'s' if len(names) > 1 else ''} {some}" if names else f"no {what}"


def greet(context: CheckContext) -> None:
    """Have the node's process know our endpoints: asked last, a question for its parameters is answered after that."""
    node = context.grader_node
    offers = [name for name, _ in node.node.get_service_names_and_types() if name.endswith(LIST_SERVICE)]
    if offers:
        client = node.client(ListParameters, offers[0])
        context.wait_until(client.is_ready, _GREET_S, step_s=GRAPH_STEP_S)
        is_answered(context, client, ListParameters.Request(), _GREET_S)
    else:
        clock = context.clock()
        context.wait_until(lambda: clock.wall() > 0.1, _GREET_S)  # noqa: PLR2004 - seconds


def is_answered(context: CheckContext, client: ServiceClient, request: Message, seconds: float) -> bool:
    """Whether a server answers within so many seconds, whatever it says; it is asked a second time meanwhile."""
    # On a loaded machine rmw_fastrtps drops a response while the server's process has not noticed the client.
    sent, clock = client.send(request), context.clock()

    def has_come() -> bool:
        if sent.sent == 1 and clock.wall() > _ASK_AGAIN_S:
            sent.send_again()
        return sent.answered()

    return context.wait_until(has_come, seconds)


def explain_silent_topic(context: CheckContext, sent: str, missing: str, seconds: str) -> exits.Cause:
    """Why nothing came on the topic `missing` within some seconds after a message on the topic `sent`."""
    seen = hangs.doing(context)
    if seen.callback is not None:
        context.spoil()
        where = exits.source_line(context.job, seen.callback)
        if hangs.computes(context):
            return "limit.time", f"Your callback was still computing in {where} after {seconds} s."
        return None, f"Your callback is blocked in {where}; meanwhile nothing is published."
    if logged := exceptions.of_logged(context.program.status(fresh=True).stderr, context.job):
        context.spoil()
        return logged
    return "topic.silent", f"Your node received a message on {sent} but published none on {missing}."


def _not_offered(context: CheckContext, wanted: WantedEndpoint, expected: str) -> Failed:
    offers = wanted.offers(context.grader_node)
    nodes = context.grader_node.nodes()
    context.spoil()
    got = "; ".join(f"{offer.name} [{offer.type}]" for offer in offers) or list_names(nodes, "node")
    evidence = Evidence("", expected, f"on the graph: {got}")
    types = [offer.type for offer in offers if offer.name == wanted.name]
    if wanted.type in types:
        message = (
            f"The {wanted.kind} {wanted.name} exists with the right type, but a client cannot connect to all of it. "
            "Make it with the default QoS profile, and keep it as long as the node."
        )
        return Failed(evidence, message)
    if types:
        message = f"The {wanted.kind} {wanted.name} has type {types[0]}, expected {wanted.type}."
        return Failed(evidence, message, "type.interface")
    if offers:
        alike = [offer.name for offer in offers if offer.type == wanted.type] or [offer.name for offer in offers]
        message = f"No {wanted.kind} is called {wanted.name}.{name_nearest(wanted.name, alike)}"
        return Failed(evidence, message, f"name.{wanted.kind}")
    if nodes:
        return Failed(evidence, f"Your node {nodes[0]} is running, but it offers no {wanted.kind}.", None)
    return Failed(evidence, *why_empty(context, wanted.name)[::-1])


def _found(context: CheckContext, end: WantedEndpoint) -> list[topic.Endpoint]:
    node = context.grader_node
    return node.publishers(end.name) if end.kind == "publisher" else node.subscriptions(end.name)


def _fitting(context: CheckContext, end: WantedEndpoint) -> list[topic.Endpoint]:
    return [one for one in _found(context, end) if one.type == end.type]


def _require_topic(context: CheckContext, end: WantedEndpoint, expected: str) -> None:
    verb, found, fitting = _VERBS[end.kind], _found(context, end), _fitting(context, end)
    if not found:
        others = context.grader_node.topics()
        message = f"No node {verb} {end.name}.{name_nearest(end.name, others)}"
        evidence = Evidence("", expected, f"on the graph: {list_names(others, 'topic')}")
        raise Failed(evidence, message, "topic.silent")
    if not fitting:
        evidence = Evidence("", expected, f"{verb} {end.name} [{found[0].type}]")
        message = f"Your node {verb} {end.name} with type {found[0].type}, expected {end.type}."
        raise Failed(evidence, message, "type.interface")
    reasons = [_mismatch(one.qos, publishes=end.kind == "publisher") for one in fitting]
    if all(reasons):
        evidence = Evidence("", expected, f"{verb} {end.name} with the QoS {_policies(fitting[0].qos)}")
        message = f"Your end is {_policies(fitting[0].qos)}, the other one {_policies(_DEFAULT)}: they do not connect."
        raise Failed(evidence, f"{message} The middleware says: {reasons[0]}", "topic.qos")


def _mismatch(qos: QoSProfile, *, publishes: bool) -> str:
    """Why an endpoint with the default profile at the other end does not connect; nothing when it does."""
    compatibility, reason = qos_check_compatible(*((qos, _DEFAULT) if publishes else (_DEFAULT, qos)))
    return str(reason) or "incompatible" if compatibility == QoSCompatibility.ERROR else ""


def _policies(qos: QoSProfile) -> str:
    return f"{qos.reliability.name.lower()}, {qos.durability.name.lower()}"
