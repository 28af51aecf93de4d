"""Declared checks of what is on the graph: endpoints with their types, the node's name. And a program that is up."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.checks.check import Evidence
from course_kit.grading.checks.declared.around import made
from course_kit.grading.checks.declared.wanted import (
    ENDS,
    SERVERS,
    await_topics,
    expect_server,
    meet,
    server_of,
    service_of,
    topic_of,
)
from course_kit.grading.checks.discovery import expect_node, start_again
from course_kit.grading.checks.topics import expect_endpoints

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration, WantedEndpoint


def offered(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each endpoint is there, with its type, and a default one connects with it.

    Raises:
        Failed: one is not.
    """
    if context.spoiled:
        ensure_up(context, check.endpoints)
    return _expect(context, check.endpoints, around, check.keys.get("request"))


def node_name(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """The node has its name.

    Raises:
        Failed: it has another, or there is none.
    """
    return expect_node(context, check.node, lambda: ensure_up(context, _all(around)))


def ensure_up(context: CheckContext, endpoints: Mapping[str, WantedEndpoint]) -> None:
    """Have a running submission with these endpoints: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up, or without one of them.
    """
    if context.spoiled:
        server = next((one for one in endpoints.values() if one.kind in SERVERS), None)
        if server is None:
            context.launch()
        else:
            start_again(context, server_of(server))
    meet(context, endpoints.values())


def await_up(context: CheckContext, around: Around) -> None:
    """Wait until a program that has just been started offers what the exercise names.

    Raises:
        Failed: it does not.
    """
    _expect(context, _all(around), around, None)


def _expect(
    context: CheckContext, endpoints: Mapping[str, WantedEndpoint], around: Around, fields: Mapping[str, object] | None
) -> Evidence:
    told = []
    for endpoint in endpoints.values():
        if endpoint.kind == "service":
            given = fields or around.valid_request(endpoint.name, context.job.seed) or {}
            request = made(service_of(endpoint).interface.Request, dict(given), "the request")
            told.append(expect_server(context, endpoint, request).expected)
        elif endpoint.kind == "action":
            told.append(expect_server(context, endpoint).expected)
    ends = [one for one in endpoints.values() if one.kind in ENDS]
    if ends:
        await_topics(context, ends)
        published, subscribed = ([topic_of(one) for one in ends if one.kind == kind] for kind in ENDS)
        told.append(expect_endpoints(context, published, subscribed).expected)
    return Evidence("", "; ".join(told), "; ".join(told))


def _all(around: Around) -> dict[str, WantedEndpoint]:
    """The endpoints of all declared checks."""
    found = (endpoint for check in around.declarations for endpoint in check.endpoints.values())
    return {f"{one.kind} {one.name}": one for one in found}
