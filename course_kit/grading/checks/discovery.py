"""Waits until a submission offers what its exercise names, and says what stands there instead when it does not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading.checks import graph
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import GRAPH_STEP_S, SubmissionEndedError
from course_kit.grading.diagnosis import exits, hangs

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.grader_node import Offer

_SETTLED_S = 2.0  # a node that is up and spinning for so long has made the servers it will make
_NODE_S = 1.5  # a node's name arrives a moment after its endpoints
_OTHER_TYPE_S = 0.5  # the right name with another type: the node was seen to offer just that


@dataclass(frozen=True)
class Wanted:
    """What is to be on the graph.

    Attributes:
        kind: "service" or "action", also the last part of the diagnosis for a wrong name.
        name: its full name.
        type: the interface's name, `package/srv/Name`.
    """

    kind: str
    name: str
    type: str


def await_offer(
    context: CheckContext, wanted: Wanted, ready: Callable[[], bool], offers: Callable[[], list[Offer]]
) -> None:
    """Wait until a server is there.

    Args:
        context: the context of the check.
        wanted: what for.
        ready: whether the grader's own clients are connected with it.
        offers: everything of this kind on the graph, for the explanation.

    Raises:
        Failed: it does not come; with start.*, name.*, type.interface or limit.*.
    """
    expected = f"the {wanted.kind} {wanted.name} of type {wanted.type}"
    clock = context.clock()

    def other_type() -> bool:
        return clock.wall() > _OTHER_TYPE_S and any(
            offer.name == wanted.name and offer.type != wanted.type for offer in offers()
        )

    def settled() -> bool:
        return clock.past(_SETTLED_S) and bool(context.grader_node.nodes()) and hangs.spins(context)

    def decided() -> bool:
        return ready() or other_type() or settled()

    try:
        context.wait_for_start(decided)
    except SubmissionEndedError as ended:
        diagnosis, message = exits.of_start(ended.process, context.job)
        raise Failed(Evidence("", expected, "a program that has ended"), message, diagnosis) from None
    if not ready():
        raise _not_offered(context, wanted, offers(), expected)


def ensure_running(context: CheckContext, wanted: Wanted, ready: Callable[[], bool]) -> None:
    """Have a running submission: one that has died or hangs is started again.

    Args:
        context: the context of the check.
        wanted: what it is to offer.
        ready: whether the grader's own clients are connected with it; asked after a new start only.

    Raises:
        Failed: it does not come up a second time.
    """
    if context.spoiled:
        start_again(context, wanted, ready)


def start_again(
    context: CheckContext, wanted: Wanted, ready: Callable[[], bool], variables: Mapping[str, str] | None = None
) -> None:
    """End the submission and start it anew, with other environment variables if wanted.

    Raises:
        Failed: it does not come up a second time.
    """
    context.launch(variables=variables)
    try:
        if context.wait_for_start(ready):
            return
    except SubmissionEndedError:
        pass
    context.spoil()
    evidence = Evidence("", f"the {wanted.kind} {wanted.name}, started again", f"no {wanted.kind}")
    raise Failed(evidence, "Your program started once, but did not come up when it was started again.")


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
    try:
        ensure()
        found = context.wait_until(lambda: name in context.grader_node.nodes(), _NODE_S, step_s=GRAPH_STEP_S)
    except SubmissionEndedError as ended:
        raise Failed(Evidence("", expected, "a program that has ended"), ended.message, ended.diagnosis) from None
    if found:
        return Evidence("", expected, expected)
    nodes = context.grader_node.nodes()
    got = f"on the graph: {', '.join(nodes) or 'no node'}"
    message = f"The graph has {graph.listed(nodes, 'node')}, but none is called {name}.{graph.closest(name, nodes)}"
    raise Failed(Evidence("", expected, got), message, "name.node")


def _not_offered(context: CheckContext, wanted: Wanted, offers: Sequence[Offer], expected: str) -> Failed:
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
