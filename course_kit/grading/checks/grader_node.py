"""The grader's own node: a context, a node and what receives for it on one thread, in one ROS domain.

An action is three services and two topics below its name ("Actions" in the ROS 2 design articles). The grader uses
these themselves, not rclpy's ActionClient: that one drops feedback which arrives after the result, and hides the rest.
"""

from __future__ import annotations

from array import array
from collections import deque
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import rclpy
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions

from course_kit.grading.checks.evidence import GRADER, Evidence, ExchangeLog, Failed, in_one_line
from course_kit.ros import graph
from course_kit.ros.graph import quiet_node
from course_kit.ros.service import ServiceClient
from course_kit.ros.topic import NO_PUBLISHER_EVENTS, NO_SUBSCRIPTION_EVENTS

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.publisher import Publisher
    from rclpy.subscription import Subscription
    from rclpy.topic_endpoint_info import TopicEndpointInfo

    from course_kit.ros.messages import ActionType, Message, MessageType, ServiceType

LONGEST_TEXT = 4096  # characters of a text in a message that are kept: a message of 8 MB would stand in every check
MOST_ELEMENTS = 1000  # of a sequence in a message
_KEPT = 1000  # messages of a topic; a program in a hurry sends more in a second
_MOST_REQUESTS = 1000  # for a service of ours
_AT_ONCE = 100  # of a topic that are taken in a row: such a program never stops
_MOST_SEEN = 30  # nodes that are drawn
DEPTH = 10  # of queues, as the tutorials of ROS 2 have it
# Of nodes, by the kind of an endpoint.
ROLES = {"service": graph.SERVES, "action": graph.RUNS, "publisher": graph.PUBLISHES, "subscription": graph.LISTENS}
NAME = "_course_kit_grader"  # hidden from `ros2 node list`, as names with an underscore are
_MOST_FEEDBACK = 10_000  # messages about one goal that are kept
_MOST_CHANGES = 20  # of the status of one goal
_ENTRIES, _IDENTIFIER, _STATUS_AT = 8, 16, 24  # bytes of a serialized status message: before, and in, an entry
_FEEDBACK = QoSProfile(depth=1000)
_STATUS = QoSProfile(depth=100, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)


def bound_message(message: Any) -> Any:
    """A message, or what a field holds, in which no text and no sequence is too long; it is changed, not copied."""
    if isinstance(message, str):
        return message[:LONGEST_TEXT]
    if isinstance(message, (list, array)):
        last = message[-MOST_ELEMENTS:] if len(message) > MOST_ELEMENTS else message
        return list(map(bound_message, last)) if isinstance(last, list) else last
    for name in getattr(message, "get_fields_and_field_types", dict)():
        value = getattr(message, name)
        if (bounded := bound_message(value)) is not value:
            setattr(message, name, bounded)
    return message


class BoundedInbox:
    """The last messages of a topic, each with its texts and sequences cut where they are too long."""

    def __init__(self) -> None:
        self.count = 0  # of all that have come
        self.heard = 0  # how many of them have been looked at
        self.messages: deque[Message] = deque(maxlen=_KEPT)
        self.times: deque[float] = deque(maxlen=_KEPT)

    def keep(self, message: Message, received_s: float) -> None:
        """Keep one message, with the time the middleware noted, however late it is looked at."""
        self.count += 1
        self.messages.append(bound_message(message))
        self.times.append(received_s)

    def newer_than(self, count: int) -> list[Message]:
        """The messages after the first `count`, as far as they are kept."""
        forgotten = self.count - len(self.messages)
        return list(self.messages)[max(count - forgotten, 0) :]


class OfferedService:
    """A service of the grader, which a learner's node calls.

    Attributes:
        answer: the response that each request gets at once; requests wait for `reply` while it is None.
        requests: the last that have come.
    """

    def __init__(self, node: Node, name: str, interface: ServiceType, record: ExchangeLog) -> None:
        self._type, self._record = interface, record
        self.rclpy_service = node.create_service(interface, name, lambda _, response: response)
        self.answer: Message | None = None
        self.requests: deque[Message] = deque(maxlen=_MOST_REQUESTS)
        self._waiting: deque[Any] = deque(maxlen=_MOST_REQUESTS)  # the headers of requests without an answer

    def take(self) -> None:
        """Take one request in."""
        request, header = self.rclpy_service.handle.service_take_request(self._type.Request)
        if header is None:
            return
        self.requests.append(bound_message(request))
        self._waiting.append(header)
        text = f"request {self.rclpy_service.srv_name}: {in_one_line(self.requests[-1])}"
        self._record.begin_exchange().add_received(text, "request")
        if self.answer is not None:
            self.reply(self.answer)

    def reply(self, response: Message, most: int = _MOST_REQUESTS) -> None:
        """Answer every request that waits, or so many of them, those that came first."""
        for _ in range(min(most, len(self._waiting))):
            self._record.add_sent(f"response: {in_one_line(response)}", "response")
            self.rclpy_service.send_response(response, self._waiting.popleft())


class GraderNode:
    """The grader on the graph; it receives by a wait set, at a fifth of the computing of an rclpy executor."""

    def __init__(self, domain: int | None) -> None:
        """Join the graph of `domain`, or of ROS_DOMAIN_ID when None."""
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        self.node = quiet_node(NAME, self._context)
        self._clients: dict[tuple[str, int], ServiceClient] = {}
        self._inboxes: dict[str, BoundedInbox] = {}
        self._actions: dict[str, ActionChannels] = {}
        self._publishers: dict[str, Publisher] = {}
        self._services: dict[str, OfferedService] = {}
        # By the handle's address, as the wait set names what is ready.
        self._takers: dict[int, Callable[[], object]] = {}
        self._waking: list[Subscription] = []
        self._quiet: list[Callable[[], bool]] = []  # takers of what does not wake
        self._nothing = rclpy_implementation.GuardCondition(self._context.handle)  # a wait set must not be empty
        self._wait_set: rclpy_implementation.WaitSet | None = None

    def spin_once(self, timeout_s: float) -> None:
        """Take in at most one message for each, after waiting at most `timeout_s` seconds for any."""
        try:
            ready = self._wait(timeout_s)
            for take in self._quiet:
                for _ in range(_AT_ONCE):
                    if not take():
                        break
            for kind in ("subscription", "client", "service"):
                for pointer in ready.get_ready_entities(kind):
                    self._takers[pointer]()
        except (MemoryError, SystemError):  # the second, where an allocation in rclpy's own code has failed
            evidence = Evidence(got="messages too large for the grader's memory")
            why = "more data than the grader can hold in memory: messages that are too large, or too many of them"
            raise Failed(evidence, f"Your program sends {why}.", "limit.memory") from None

    def client(self, interface: ServiceType, name: str, number: int = 0) -> ServiceClient:
        """The client `number` of a service; made on first use and kept, so that it is connected the next time."""
        key = (name, number)
        if key not in self._clients:
            self._clients[key] = client = ServiceClient(self.node, interface, name)
            self._await(client.rclpy_client.handle, lambda: _take_response(client))
        return self._clients[key]

    def inbox(self, interface: MessageType, topic: str) -> BoundedInbox:
        """What comes on a topic, from the first use on; with the default profile of depth 10."""
        if topic not in self._inboxes:
            self._inboxes[topic] = inbox = BoundedInbox()
            self.listen(interface, topic, DEPTH, inbox.keep, wakes=True)
        return self._inboxes[topic]

    def action(self, interface: ActionType, name: str) -> ActionChannels:
        """The connections with an action; made on first use and kept."""
        if name not in self._actions:
            self._actions[name] = ActionChannels(self, name, interface)
        return self._actions[name]

    def listen(  # noqa: PLR0913 - what tells topics apart
        self,
        interface: MessageType,
        topic: str,
        qos: QoSProfile | int,
        keep: Callable[[Any, float], None],
        *,
        raw: bool = False,
        wakes: bool = False,  # whether a message ends a wait, as that costs computing for each
    ) -> None:
        """Have `keep` called with each message on a topic and its time."""
        events = NO_SUBSCRIPTION_EVENTS
        made = self.node.create_subscription(interface, topic, lambda _: None, qos, event_callbacks=events, raw=raw)
        take = partial(_take_message, made, keep)
        if wakes:
            self._waking.append(made)
            self._await(made.handle, take)
        else:
            self._quiet.append(take)

    def publisher(self, interface: MessageType, topic: str) -> Publisher:
        """The publisher on a topic, with the default QoS profile of depth 10; made on first use and kept."""
        if topic not in self._publishers:
            events = NO_PUBLISHER_EVENTS
            self._publishers[topic] = self.node.create_publisher(interface, topic, DEPTH, event_callbacks=events)
        return self._publishers[topic]

    def offer_service(self, name: str, interface: ServiceType, record: ExchangeLog) -> OfferedService:
        """Receive the requests for a service; made on first use and kept."""
        if name not in self._services:
            self._services[name] = offered = OfferedService(self.node, name, interface, record)
            self._await(offered.rclpy_service.handle, offered.take)
        return self._services[name]

    def ends(self, kind: str, topic: str) -> list[TopicEndpointInfo]:
        """Who else is a "publisher" on a topic, or a "subscription" to it."""
        found: list[TopicEndpointInfo] = getattr(self.node, f"get_{kind}s_info_by_topic")(topic)
        return [end for end in found if end.node_name != NAME]

    def see_graph(self) -> graph.Overview:
        """Who talks to whom at this moment, the grader where it stands in for somebody; of a crowd only a part."""
        seen = graph.read_graph(self.node, most=_MOST_SEEN)
        there = {(use.channel, use.role) for use in seen.uses}
        own = (use for use in graph.uses_of(self.node, f"/{NAME}") if not graph.is_plumbing(use))
        uses = (use._replace(node=f"/{GRADER}") for use in own if (use.channel, use.role) not in there)
        return graph.Overview((*seen.nodes, f"/{GRADER}"), (*seen.uses, *uses))

    def nodes(self) -> list[str]:
        """Full names of all other nodes; a name stands as often as nodes carry it."""
        return [name for name in graph.node_names(self.node) if not name.endswith(f"/{NAME}")]

    def offers(self, kind: str) -> list[tuple[str, str]]:
        """Name and type of what other nodes have of a kind of endpoints, but for what ROS itself has made."""
        uses = (use for name in set(self.nodes()) for use in graph.uses_of(self.node, name, ROLES[kind]))
        return sorted({(use.channel, each) for use in uses if not graph.is_plumbing(use) for each in use.types})

    def close(self) -> None:
        """Leave the graph."""
        self.node.destroy_node()
        self._context.try_shutdown()

    def _await(self, handle: Any, take: Callable[[], object]) -> None:
        self._takers[handle.pointer] = take
        self._wait_set = None

    def _wait(self, timeout_s: float) -> rclpy_implementation.WaitSet:
        if self._wait_set is None:
            sizes = len(self._waking), 1, 0, len(self._clients), len(self._services), 0
            self._wait_set = rclpy_implementation.WaitSet(*sizes, self._context.handle)
        wait_set = self._wait_set
        wait_set.clear_entities()
        wait_set.add_guard_condition(self._nothing)
        for subscription in self._waking:
            wait_set.add_subscription(subscription.handle)
        for client in self._clients.values():
            wait_set.add_client(client.rclpy_client.handle)
        for offered in self._services.values():
            wait_set.add_service(offered.rclpy_service.handle)
        wait_set.wait(int(timeout_s * 1e9))
        return wait_set


def _take_message(subscription: Subscription, keep: Callable[[Any, float], None]) -> bool:
    """Take in the next message; False if none has come."""
    taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is not None:
        message, info = taken
        keep(message, info["received_timestamp"] / 1e9)
    return taken is not None


def _take_response(client: ServiceClient) -> None:
    """Take in the next response; with none, it was for another client of the same service."""
    header, response = client.rclpy_client.handle.take_response(client.type.Response)
    if header is not None:
        with suppress(KeyError):  # a second answer to the same request
            asked = client.rclpy_client.get_pending_request(header.request_id.sequence_number)
            asked.set_result(bound_message(response))


class ReceivedFeedback(NamedTuple):
    """Feedback, and when it was received, in seconds of the system's clock."""

    feedback: Message
    came_s: float


class ActionChannels:
    """The grader's connections with an action, and what has come about the goals that are followed."""

    def __init__(self, node: GraderNode, name: str, interface: ActionType) -> None:
        parts, self._below = interface.Impl, f"{name}/_action"
        self._node = node.node
        self._feedback: dict[bytes, list[ReceivedFeedback]] = {}
        self._statuses: dict[bytes, list[tuple[float, int]]] = {}
        self.goals = node.client(parts.SendGoalService, f"{self._below}/send_goal")
        self.cancels = node.client(parts.CancelGoalService, f"{self._below}/cancel_goal")
        self.results = node.client(parts.GetResultService, f"{self._below}/get_result")
        node.listen(parts.FeedbackMessage, f"{self._below}/feedback", _FEEDBACK, self.keep_feedback)
        node.listen(parts.GoalStatusMessage, f"{self._below}/status", _STATUS, self.keep_statuses, raw=True)

    def is_ready(self) -> bool:
        """Whether a goal can be sent and everything about it will be heard."""
        return all(client.is_ready() for client in (self.goals, self.results, self.cancels)) and all(
            self._node.count_publishers(f"{self._below}/{topic}") for topic in ("feedback", "status")
        )

    def follow(self, goal: bytes) -> tuple[list[ReceivedFeedback], list[tuple[float, int]]]:
        """What comes about a goal from now on: feedback, and its statuses with their times on the system's clock."""
        return self._feedback.setdefault(goal, []), self._statuses.setdefault(goal, [])

    def keep_feedback(self, message: Message, received_s: float) -> None:
        """Keep one message; of those without end the beginning and the last."""
        heard = self._feedback.get(bytes(message.goal_id.uuid))
        if heard is not None:
            del heard[_MOST_FEEDBACK - 1 :]
            heard.append(ReceivedFeedback(bound_message(message.feedback), received_s))

    def keep_statuses(self, message: bytes, received_s: float) -> None:
        """Keep of a message what is news: each has all recent goals, so it is read as it came."""
        place = _ENTRIES
        while place + _STATUS_AT < len(message):
            goal = message[place : place + _IDENTIFIER]
            place += (-place) % 4 + _STATUS_AT
            changes, status = self._statuses.get(goal), message[place]
            if changes is not None and len(changes) < _MOST_CHANGES and status not in [known for _, known in changes]:
                changes.append((received_s, status))
            place += 1
