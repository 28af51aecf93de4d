"""The endpoints that declared checks name, as the grader's verbs take them, and how the grader meets them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks import graph
from course_kit.grading.checks.actions import WantedAction
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.around import interface_of
from course_kit.grading.checks.discovery import ENDED, expect_offered, has_settled
from course_kit.grading.checks.services import Service
from course_kit.grading.checks.topics import Topic
from course_kit.grading.diagnosis import exceptions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.declaration import WantedEndpoint
    from course_kit.ros.messages import Message

SERVERS, ENDS = ("service", "action"), ("publisher", "subscription")
_MET = "declared endpoint "  # what is remembered of the running submission


def service_of(endpoint: WantedEndpoint) -> Service:
    """The service of an endpoint."""
    return Service(endpoint.name, interface_of(endpoint.type))


def action_of(endpoint: WantedEndpoint) -> WantedAction:
    """The action of an endpoint."""
    return WantedAction(endpoint.name, interface_of(endpoint.type))


def topic_of(endpoint: WantedEndpoint) -> Topic:
    """The topic of an endpoint."""
    return Topic(endpoint.name, interface_of(endpoint.type))


def server_of(endpoint: WantedEndpoint) -> Any:
    """The service or the action of an endpoint."""
    return service_of(endpoint) if endpoint.kind == "service" else action_of(endpoint)


def expect_server(context: CheckContext, endpoint: WantedEndpoint, request: Message = None) -> Evidence:
    """A service or an action is there; see `expect_offered`.

    Raises:
        Failed: it is not.
    """
    evidence = expect_offered(context, server_of(endpoint), request=request)
    context.memory[_key(endpoint)] = True
    return evidence


def meet(context: CheckContext, endpoints: Iterable[WantedEndpoint]) -> None:
    """Wait for the endpoints of a running submission, each once: it may just have been started.

    Raises:
        Failed: one is not there.
    """
    unmet = [one for one in endpoints if _key(one) not in context.memory]
    for endpoint in unmet:
        if endpoint.kind in SERVERS:
            expect_server(context, endpoint)
    if ends := [one for one in unmet if one.kind in ENDS]:
        await_topics(context, ends)


def await_topics(context: CheckContext, ends: list[WantedEndpoint]) -> None:
    """Wait for a program that was just started, until its topics are there or it has made all that it will make.

    Whether each is there, and fits, is for others to say.

    Raises:
        Failed: no node has appeared, or the program has ended.
    """
    clock, node = context.clock(), context.grader_node
    found = {"publisher": node.publishers, "subscription": node.subscriptions}

    def there() -> bool:
        return all(found[one.kind](one.name) for one in ends)

    expected = Evidence("", f"a node with {ends[0].name}")
    with exceptions.explained(context, expected, exceptions.of_start, ENDED):
        context.wait_for_start(lambda: there() or has_settled(context, clock))
    if not there() and not node.nodes():
        context.spoil()
        evidence = Evidence("", expected.expected, "on the graph: no node")
        raise Failed(evidence, *graph.why_empty(context, ends[0].name)[::-1])
    context.memory.update({_key(one): True for one in ends})


def _key(endpoint: WantedEndpoint) -> str:
    return f"{_MET}{endpoint.kind} {endpoint.name}"
