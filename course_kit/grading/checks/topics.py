"""What graders ask of topics: who is at their ends, and what a node makes of the messages it gets."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

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
from course_kit.grading.checks.named import Named
from course_kit.grading.diagnosis import exceptions, exits, hangs
from course_kit.grading.exchange_log import Exchange, in_one_line
from course_kit.ros.messages import MessageType

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message
    from course_kit.ros.topic import Endpoint, Inbox

HEARD_S = 3.0  # how long the message that answers another one is waited for
_GRAPH_S = 2.0  # how long an endpoint is waited for, of a node that is up
_AGAIN_S = 1.0  # a message sent before the subscriber has found us is lost: then it is sent again
_LATE_S = 0.15  # how long a wrong message may be followed by the right one
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
class Topic(Named[MessageType]):
    """A topic as the exercise names it."""

    kind: ClassVar[str] = "topic"


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


class TopicExchange:
    """A node that answers each message on one topic with a message on each of some others."""

    def __init__(self, context: CheckContext, sent: Topic, answers: Sequence[Topic]) -> None:
        """Prepare; the endpoints are made on first use and kept, so that they connect while others are waited for.

        Args:
            context: the check's.
            sent: the topic of the messages that are sent.
            answers: those on which something comes for each.
        """
        self._context = context
        self._sent = sent
        self._answers = tuple(answers)
        self._publisher = context.grader_node.publisher(sent.interface, sent.name)
        self._turn = Exchange()
        self._heard = tuple(context.grader_node.inbox(topic.interface, topic.name) for topic in answers)

    def send(self, message: Message, evidence: Evidence, *, about: str = "") -> tuple[Message, ...]:
        """Send one message and return the next that comes on each of the other topics.

        Args:
            message: what to send.
            evidence: what the check has so far.
            about: `Evidence.sent` of a verdict on just this message, where several are sent before the verdict.

        Raises:
            Failed: on one of them none came; with topic.silent, or with what was raised meanwhile.
        """
        self._context.require_time(evidence)
        with exceptions.explained(self._context, evidence):
            self._connect(evidence)
            places = [heard.count for heard in self._heard]
            self._tell_sent(message, about)
            self._publisher.publish(message)
            self._await([place + 1 for place in places], evidence)
            self._tell_came(places)
        return self._last()

    def wait_for_better(self, good: Callable[[tuple[Message, ...]], bool], evidence: Evidence) -> tuple[Message, ...]:
        """Give the last message on each topic a moment to become what it should be, and return it, good or not.

        A node that publishes more than once for a message, or from a timer, leaves some that are taken for answers to
        the next one; whether that is allowed is for a check of its own.
        """
        places = [heard.count for heard in self._heard]
        with exceptions.explained(self._context, evidence):
            self._context.wait_until(lambda: good(self._last()), _LATE_S)
        self._tell_came(places)
        return self._last()

    def _last(self) -> tuple[Message, ...]:
        return tuple(heard.messages[-1] for heard in self._heard)

    def _tell_sent(self, message: Message, about: str = "") -> None:
        self._turn = self._context.record.sent(f"{self._sent.name}: {in_one_line(message)}", "message", about=about)

    def _tell_came(self, places: Sequence[int]) -> None:
        """Keep what has come on each topic since there were so many messages."""
        for topic, heard, place in zip(self._answers, self._heard, places, strict=True):
            new = heard.count - place
            if new:
                what = in_one_line(heard.messages[-1]) if new == 1 else f"{new} messages"
                self._turn.came(f"{topic.name}: {what}", "message")

    def _connect(self, evidence: Evidence) -> None:
        """Make sure that both ways stand, by empty messages, which no caller counts."""
        if all(heard.count for heard in self._heard):
            return
        sent = 0
        clock = self._context.clock()

        def connected() -> bool:
            nonlocal sent
            if self._publisher.get_subscription_count() and clock.past(sent * _AGAIN_S):
                self._publisher.publish(self._sent.interface())
                sent += 1
            return all(heard.count for heard in self._heard)

        if not self._context.wait_until(connected, HEARD_S, step_s=GRAPH_STEP_S):
            self._tell_sent(self._sent.interface())
            raise self._silent([1] * len(self._heard), evidence, clock.fair())
        if sent > 1:  # whichever of them were lost: the answers to all others are to come before we go on
            self._context.wait_until(lambda: all(heard.count >= sent for heard in self._heard), _AGAIN_S)

    def _await(self, counts: Sequence[int], evidence: Evidence) -> None:
        """Wait for the next message on each topic, the one that makes it so many."""

        def come() -> bool:
            return all(heard.count >= count for heard, count in zip(self._heard, counts, strict=True))

        clock = self._context.clock()
        if not self._context.wait_until(come, HEARD_S):
            self._tell_came([count - 1 for count in counts])
            raise self._silent(counts, evidence, clock.fair())

    def _silent(self, counts: Sequence[int], evidence: Evidence, waited_s: float) -> Failed:
        missing = [
            topic.name
            for topic, heard, count in zip(self._answers, self._heard, counts, strict=True)
            if heard.count < count
        ]
        names, seconds = " and ".join(missing), hangs.told(waited_s, HEARD_S)
        self._turn.missed(f"within {seconds} s nothing on {names}")
        evidence = replace(evidence, got=f"within {seconds} s nothing on {names}")
        return Failed(evidence, *why_nothing(self._context, self._sent.name, names, seconds)[::-1])


def await_next(context: CheckContext, heard: Inbox, count: int, seconds: float, evidence: Evidence) -> bool:
    """Wait until so many messages have come in all; False when they have not within `seconds`.

    Args:
        context: the check's.
        heard: what comes on the topic.
        count: how many in all.
        seconds: the patience.
        evidence: what the check has so far.

    Raises:
        Failed: the submission has ended.
    """
    with exceptions.explained(context, evidence):
        return context.wait_until(lambda: heard.count >= count, seconds)


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
