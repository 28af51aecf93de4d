"""Waits until a submission offers what its exercise names, and says what stands there instead when it does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rcl_interfaces.srv import ListParameters

from course_kit.grading.checks import graph
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import GRAPH_STEP_S, SubmissionEndedError
from course_kit.grading.diagnosis import exits, hangs
from course_kit.grading.diagnosis.exceptions import explained, of_start
from course_kit.ros.parameters import LIST_SERVICE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.endpoints import Interface, Server
    from course_kit.grading.checks.fair_clock import FairClock
    from course_kit.grading.model.plain_data import Record
    from course_kit.ros.messages import Message
    from course_kit.ros.service import ServiceClient

ENDED = "a program that has ended"
_SETTLED_S = 2.0  # a node that is up and spinning for so long has made the servers it will make
_GREET_S = 1.0
_ASK_AGAIN_S = 0.5
RESEND_AFTER_S = 1.0  # what has not been answered for so long is sent again
_NODE_S = 1.5  # a node's name arrives a moment after its endpoints
_OTHER_TYPE_S = 0.5  # the right name with another type: the node was seen to offer just that


def expect_offered(context: CheckContext, server: Server[Interface]) -> Evidence:
    """A service or an action is on the graph, with its type, and its program is there to be asked.

    That tells a server from a program that offers a service and ends at once, however fast each is discovered.

    Raises:
        Failed: it is not; with start.*, name.*, type.interface or limit.*.
    """
    expected = f"the {server.kind} {server.name} of type {server.type}"
    _await_offer(context, server, expected)
    try:
        greet(context)
    except SubmissionEndedError as ended:
        if ended.diagnosis == "start.exit":
            raise Failed(Evidence("", expected, ENDED), ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def _await_offer(context: CheckContext, server: Server[Interface], expected: str) -> None:
    node, clock = context.grader_node, context.clock()

    def other_type() -> bool:
        return clock.wall() > _OTHER_TYPE_S and any(
            offer.name == server.name and offer.type != server.type for offer in server.offers(node)
        )

    with explained(context, Evidence("", expected), exits.of_start, ENDED):
        context.wait_for_start(lambda: server.ready(node) or other_type() or has_settled(context, clock))
    if not server.ready(node):
        raise _not_offered(context, server, expected)


def await_nodes(context: CheckContext, ends: Sequence[Record]) -> None:
    """Wait for a program that was just started, until its topics are there or it has made all that it will make.

    Raises:
        Failed: no node has appeared, or the program has ended.
    """
    clock, node = context.clock(), context.grader_node
    found = {"publisher": node.publishers, "subscription": node.subscriptions}

    def there() -> bool:
        return all(found[one["kind"]](one["name"]) for one in ends)

    evidence = Evidence("", f"a node with {ends[0]['name']}")
    with explained(context, evidence, of_start, ENDED):
        context.wait_for_start(lambda: there() or has_settled(context, clock))
    if not there() and not node.nodes():
        context.spoil()
        evidence = Evidence("", evidence.expected, "on the graph: no node")
        raise Failed(evidence, *graph.why_empty(context, ends[0]["name"])[::-1])


def has_settled(context: CheckContext, clock: FairClock) -> bool:
    """Whether a node is up and spinning for so long that it has made all it will make.

    Args:
        context: the context of the check.
        clock: begun when the waiting began.
    """
    return clock.past(_SETTLED_S) and bool(context.grader_node.nodes()) and hangs.spins(context)


def expect_node(context: CheckContext, name: str, ensure: Callable[[], None]) -> Evidence:
    """A node of this full name is on the graph.

    Args:
        context: the context of the check.
        name: the node's full name.
        ensure: has the submission running, or raises Failed.

    Raises:
        Failed: it is not; with name.node.
    """
    expected = f"a node called {name}"
    with explained(context, Evidence("", expected), exits.of_call, ENDED):
        ensure()
        found = context.wait_until(lambda: name in context.grader_node.nodes(), _NODE_S, step_s=GRAPH_STEP_S)
    if found:
        return Evidence("", expected, expected)
    nodes = context.grader_node.nodes()
    raise other_nodes(name, nodes, Evidence("", expected, f"on the graph: {', '.join(nodes) or 'no node'}"))


def first_node(context: CheckContext) -> str:
    """The full name of the program's only node, or of its first one by the alphabet.

    Raises:
        Failed: no node is there.
    """
    if not context.wait_until(lambda: bool(context.grader_node.nodes()), _NODE_S, step_s=GRAPH_STEP_S):
        raise Failed(
            Evidence("", "a node", "no node is on the graph"), "Your program runs, but no node of it is there."
        )
    return context.grader_node.nodes()[0]


def other_nodes(name: str, nodes: Sequence[str], evidence: Evidence) -> Failed:
    """There are nodes, but none of this name.

    Args:
        name: the full name that was wanted.
        nodes: those there are.
        evidence: of the check.
    """
    message = f"The graph has {graph.listed(nodes, 'node')}, but none is called {name}.{graph.closest(name, nodes)}"
    return Failed(evidence, message, "name.node")


def _not_offered(context: CheckContext, wanted: Server[Interface], expected: str) -> Failed:
    offers = wanted.offers(context.grader_node)
    nodes = context.grader_node.nodes()
    context.spoil()
    got = "; ".join(f"{offer.name} [{offer.type}]" for offer in offers) or graph.listed(nodes, "node")
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
        alike = [offer for offer in offers if offer.type == wanted.type] or offers
        message = (
            f"No {wanted.kind} is called {wanted.name}.{graph.closest(wanted.name, [offer.name for offer in alike])}"
        )
        return Failed(evidence, message, f"name.{wanted.kind}")
    if nodes:
        return Failed(evidence, f"Your node {nodes[0]} is running, but it offers no {wanted.kind}.", None)
    return Failed(evidence, *graph.why_empty(context, wanted.name)[::-1])


def greet(context: CheckContext) -> None:
    """Have the node's process know our endpoints: asked last, a question for its parameters is answered after that.

    Raises:
        SubmissionEndedError: the program has ended.
    """
    node = context.grader_node
    offers = [name for name, _ in node.node.get_service_names_and_types() if name.endswith(LIST_SERVICE)]
    if offers:
        client = node.client(ListParameters, offers[0])
        context.wait_until(client.is_ready, _GREET_S, step_s=GRAPH_STEP_S)
        answers(context, client, ListParameters.Request(), _GREET_S)
    else:
        clock = context.clock()
        context.wait_until(lambda: clock.wall() > 0.1, _GREET_S)  # noqa: PLR2004 - seconds


def answers(context: CheckContext, client: ServiceClient, request: Message, seconds: float) -> bool:
    """Whether a server answers within so many seconds, whatever it says; it is asked a second time meanwhile.

    On a loaded machine the middleware drops a response as long as the server's process has not noticed the client
    (rmw_fastrtps waits 0.1 s for that).

    Raises:
        SubmissionEndedError: the program has ended.
    """
    sent, clock = client.send(request), context.clock()

    def came() -> bool:
        if sent.sent == 1 and clock.wall() > _ASK_AGAIN_S:
            sent.send_again()
        return sent.answered()

    return context.wait_until(came, seconds)
