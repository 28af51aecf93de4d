"""Declared checks of what is on the graph: endpoints with their types, the node's name. And a program that is up."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks import graph
from course_kit.grading.checks.actions import WantedAction
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import SubmissionEndedError
from course_kit.grading.checks.declared.around import interface_of, made
from course_kit.grading.checks.declared.declaration import Declaration
from course_kit.grading.checks.declared.services import service_of
from course_kit.grading.checks.discovery import ENDED, ensure_ready, expect_node, expect_offered, has_settled
from course_kit.grading.checks.topics import Topic, expect_endpoints
from course_kit.grading.diagnosis import exceptions

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import WantedEndpoint


def offered(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each endpoint is there, with its type, and a default one connects with it.

    Raises:
        Failed: one is not.
    """
    told = []
    for endpoint in check.endpoints.values():
        if endpoint.kind == "service":
            service = service_of(endpoint)
            fields = check.keys.get("request") or around.valid_request(endpoint.name, context.job.seed) or {}
            told.append(
                expect_offered(context, service, made(service.interface.Request, fields, "the request")).expected
            )
        elif endpoint.kind == "action":
            told.append(expect_offered(context, action_of(endpoint)).expected)
    ends = {kind: [topic_of(one) for one in check.endpoints.values() if one.kind == kind] for kind in _ENDS}
    if any(ends.values()):
        if not told:
            _await_topics(context, ends)
        told.append(expect_endpoints(context, ends["publisher"], ends["subscription"]).expected)
    return Evidence("", "; ".join(told), "; ".join(told))


def node_name(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """The node has its name.

    Raises:
        Failed: it has another, or there is none.
    """
    return expect_node(context, check.node, lambda: ensure_up(context, around))


def ensure_up(context: CheckContext, around: Around) -> None:
    """Have a running submission: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up a second time.
    """
    if not context.spoiled:
        return
    endpoints = [one for check in around.declarations for one in check.endpoints.values()]
    for endpoint in endpoints:
        if endpoint.kind in ("service", "action"):
            server: Any = service_of(endpoint) if endpoint.kind == "service" else action_of(endpoint)
            ensure_ready(context, server)
            return
    context.launch()
    try:
        came = context.wait_for_start(lambda: _all_there(context, endpoints))
    except SubmissionEndedError:
        came = False
    if not came:
        context.spoil()
        evidence = Evidence("", "your program, started again", "no topic of it")
        raise Failed(evidence, "Your program started once, but did not come up when it was started again.")


def await_up(context: CheckContext, around: Around) -> None:
    """Wait until a program that has just been started offers what the exercise names.

    Raises:
        Failed: it does not.
    """
    endpoints = {one.name: one for check in around.declarations for one in check.endpoints.values()}
    look = Declaration("up", "offered", "", 0.0, 0.0, endpoints=endpoints)
    offered(context, look, around)


def action_of(endpoint: WantedEndpoint) -> WantedAction:
    """The action of an endpoint."""
    return WantedAction(endpoint.name, interface_of(endpoint.type))


def topic_of(endpoint: WantedEndpoint) -> Topic:
    """The topic of an endpoint."""
    return Topic(endpoint.name, interface_of(endpoint.type))


_ENDS = ("publisher", "subscription")


def _await_topics(context: CheckContext, ends: Mapping[str, Sequence[Topic]]) -> None:
    """Wait for a program that was just started, until its topics are there or it has made all that it will make."""
    clock, node = context.clock(), context.grader_node
    published, subscribed = ends["publisher"], ends["subscription"]
    first = (*subscribed, *published)[0].name

    def there() -> bool:
        return all(node.publishers(one.name) for one in published) and all(
            node.subscriptions(one.name) for one in subscribed
        )

    with exceptions.explained(context, Evidence("", f"a node with {first}"), exceptions.of_start, ENDED):
        context.wait_for_start(lambda: there() or has_settled(context, clock))
    if not there() and not node.nodes():
        context.spoil()
        evidence = Evidence("", f"a node with {first}", "on the graph: no node")
        raise Failed(evidence, *graph.why_empty(context, first)[::-1])


def _all_there(context: CheckContext, endpoints: Sequence[WantedEndpoint]) -> bool:
    node = context.grader_node
    found = {"publisher": node.publishers, "subscription": node.subscriptions}
    return all(found[one.kind](one.name) for one in endpoints if one.kind in found)
