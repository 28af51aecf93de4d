"""What graders ask of topics: who is at their ends, and what a node makes of the messages it gets."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.duration import Infinite
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)

from course_kit.grading.checks import graph
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import GRAPH_STEP_S
from course_kit.grading.checks.grader_node import DEPTH
from course_kit.grading.diagnosis import exceptions, exits, hangs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.endpoints import Topic
    from course_kit.ros.topic import Endpoint

_GRAPH_S = 2.0  # how long an endpoint is waited for, of a node that is up
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


def expect_endpoints(context: CheckContext, published: Sequence[Topic], subscribed: Sequence[Topic]) -> Evidence:
    """The submission publishes and subscribes to these topics, so that a default reliable endpoint connects.

    Args:
        context: the check's.
        published: the topics the submission publishes.
        subscribed: those it listens to.

    Raises:
        Failed: something is missing or does not fit; with topic.silent, type.interface or topic.qos.
    """
    expected = "; ".join(
        [f"publishes {topic.name} [{topic.type}]" for topic in published]
        + [f"subscribes to {topic.name} [{topic.type}]" for topic in subscribed]
    )
    evidence = Evidence("", expected, expected)
    ends = [(topic, True) for topic in published] + [(topic, False) for topic in subscribed]
    with exceptions.explained(context, evidence):
        context.wait_until(lambda: all(_fitting(context, *end) for end in ends), _GRAPH_S, step_s=GRAPH_STEP_S)
    for topic, publishes in ends:
        _require(context, topic, expected, publishes=publishes)
    return evidence


def _found(context: CheckContext, topic: Topic, publishes: bool) -> list[Endpoint]:
    return context.grader_node.publishers(topic.name) if publishes else context.grader_node.subscriptions(topic.name)


def _fitting(context: CheckContext, topic: Topic, publishes: bool) -> list[Endpoint]:
    return [end for end in _found(context, topic, publishes) if end.type == topic.type]


def _require(context: CheckContext, topic: Topic, expected: str, *, publishes: bool) -> None:
    verb = "publishes" if publishes else "subscribes to"
    found, fitting = _found(context, topic, publishes), _fitting(context, topic, publishes)
    if not found:
        others = context.grader_node.topics()
        message = f"No node {verb} {topic.name}.{graph.closest(topic.name, others)}"
        raise Failed(Evidence("", expected, f"on the graph: {graph.listed(others, 'topic')}"), message, "topic.silent")
    if not fitting:
        evidence = Evidence("", expected, f"{verb} {topic.name} [{found[0].type}]")
        message = f"Your node {verb} {topic.name} with type {found[0].type}, expected {topic.type}."
        raise Failed(evidence, message, "type.interface")
    reasons = [_mismatch(end, publishes=publishes) for end in fitting]
    if all(reasons):
        evidence = Evidence("", expected, f"{verb} {topic.name} with the QoS {_policies(fitting[0].qos)}")
        message = f"Your end is {_policies(fitting[0].qos)}, the other one {_policies(_DEFAULT)}: they do not connect."
        raise Failed(evidence, f"{message} The middleware says: {reasons[0]}", "topic.qos")


def _mismatch(end: Endpoint, *, publishes: bool) -> str:
    """Why an endpoint with the default profile at the other end does not connect; nothing when it does."""
    pair = (end.qos, _DEFAULT) if publishes else (_DEFAULT, end.qos)
    compatibility, reason = qos_check_compatible(*pair)
    return str(reason) or "incompatible" if compatibility == QoSCompatibility.ERROR else ""


def _policies(qos: QoSProfile) -> str:
    return f"{qos.reliability.name.lower()}, {qos.durability.name.lower()}"


def why_nothing(context: CheckContext, sent: str, missing: str, seconds: str) -> exits.Cause:
    """Why nothing came for a message.

    Args:
        context: the check's.
        sent: the topic of the message.
        missing: where something should have come.
        seconds: for how long it was waited for.
    """
    seen = hangs.doing(context)
    if seen.callback is not None:
        context.spoil()
        where = exits.source_line(context.job, seen.callback.line)
        if hangs.computes(context):
            return "limit.time", f"Your callback was still computing in {where} after {seconds} s."
        return None, f"Your callback is blocked in {where}; meanwhile nothing is published."
    if logged := exceptions.of_logged(context.process(fresh=True).stderr, context.job):
        context.spoil()
        return logged
    return "topic.silent", f"Your node received a message on {sent} but published none on {missing}."
