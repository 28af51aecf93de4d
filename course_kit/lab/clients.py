"""The lab's own hidden node, with a client for each service and action and a publisher for each topic it has used."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict, deque
from typing import TYPE_CHECKING, Any, NamedTuple

from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.qos import qos_profile_services_default
from rclpy.validate_topic_name import validate_topic_name

from course_kit.lab.errors import ActionNotFoundError, LabError, ServiceNotFoundError, error_text
from course_kit.ros import graph
from course_kit.ros.compat import rcl_error
from course_kit.ros.goal import GoalClient
from course_kit.ros.graph import quiet_node
from course_kit.ros.messages import type_name
from course_kit.ros.names import full_action_name, is_hidden, is_of_every_node, nearest_name
from course_kit.ros.service import ServiceClient
from course_kit.ros.topic import types_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.publisher import Publisher
    from rclpy.qos import QoSProfile
    from rclpy.subscription import Subscription

    from course_kit.lab.recording.hooks import MessageHooks
    from course_kit.lab.runtime.executor import ExecutorThread
    from course_kit.ros.messages import ActionType, Message, ServiceType

LAB_NAME = "lab"  # what its own node is called in a recording
HIDDEN_NAME = "_lab_"  # and the process's number, so that two notebooks do not share it
_POLL = 0.005  # seconds
_FREE = 1.0  # seconds in which the lab's thread must be free to make a client
_KEPT = 32  # clients and publishers; the one unused for longest goes first


class WantedServer(NamedTuple):
    """A server that was looked for."""

    role: graph.Role
    name: str
    type: str


def not_found(node: Node, wanted: WantedServer, waited: float, except_by: frozenset[str] = frozenset()) -> LabError:
    """The error that says why no such server was found, and what to do."""
    kind = ServiceNotFoundError if wanted.role == graph.SERVES else ActionNotFoundError
    return kind(_not_offered(node, wanted, waited, except_by))


def _not_offered(node: Node, wanted: WantedServer, waited: float, except_by: frozenset[str]) -> str:
    role, name, wanted_type = wanted
    offered = graph.offered_types(node, role, except_by)
    there = {one: types for one, types in offered.items() if not (is_of_every_node(one) or is_hidden(one))}
    types = there.get(name)
    if types and wanted_type not in types:
        asked = "you called it with" if role == graph.SERVES else "the goal was one of"
        return (
            f"{name} has the type {' and '.join(sorted(types))}, but {asked} {wanted_type}. "
            "Client and server must use the same type."
        )
    message = f"No node {role.verb} {name} (waited {waited:g} s). "
    if near := nearest_name(name, there):
        return f"{message}The nearest name on the graph is {near} [{', '.join(sorted(there[near]))}]."
    if there:
        return f"{message}On the graph: {', '.join(sorted(there)[:5])}."
    return f"{message}No {role.kind} at all is on the graph: has its server been started?"


class OtherTypeError(LabError):
    """A name is in use in this lab with another type."""


class Clients:
    """What the lab speaks through."""

    def __init__(self, executor_thread: ExecutorThread, hooks: MessageHooks) -> None:
        self._executor_thread = executor_thread
        self._hooks = hooks
        self._clients: OrderedDict[tuple[Any, str], Any] = OrderedDict()
        self._publishers: OrderedDict[tuple[Any, str], Any] = OrderedDict()
        self._goal_clients: OrderedDict[tuple[Any, str], GoalClient] = OrderedDict()
        self.known_node: Node | None = None

    @property
    def node(self) -> Node:
        """The node, made on first use. The underscore in its name hides it from `ros2 node list`."""
        if self.known_node is None:
            node = quiet_node(f"{HIDDEN_NAME}{os.getpid()}", self._executor_thread.context)
            self._hooks.aliases[node.get_fully_qualified_name()] = LAB_NAME
            self._hooks.own_nodes.add(node)
            self._executor_thread.executor.add_node(node)
            self.known_node = node
        return self.known_node

    def client(self, service_type: ServiceType, service: str) -> QueuedClient:
        """The client for a service; one of the same name and another type is replaced."""

        def make() -> QueuedClient:
            client = QueuedClient(self.node, service_type, service)
            self._hooks.direct.add(client.rclpy_client)
            return client

        try:
            found: QueuedClient = self._use(self._clients, (service_type, service), make, self._drop_client)
        except OtherTypeError:
            wanted = WantedServer(graph.SERVES, self.node.resolve_service_name(service), type_name(service_type))
            own = frozenset({self.node.get_fully_qualified_name()})
            raise not_found(self.node, wanted, 0.0, own) from None
        return found

    def publisher(self, message_type: type[Message], topic: str) -> Publisher:
        """The publisher for a topic; one of the same name and another type is replaced."""

        def make() -> Any:
            return self.node.create_publisher(message_type, topic, 10)

        found: Publisher = self._use(self._publishers, (message_type, topic), make, self._drop_publisher)
        return found

    def goal_client(self, action_type: ActionType, action: str) -> GoalClient:
        """The client for an action; one of the same name and another type is replaced."""

        def make() -> Any:
            node = self.node
            validate_topic_name(action)
            types = graph.offered_types(node, graph.RUNS).get(full_action_name(node, action), [])
            if types and type_name(action_type) not in types:  # rclpy would make half a client, and lose it
                raise OtherTypeError(f"{action} is already in use with a different type than {type_name(action_type)}.")
            # On the thread that will use it, and not while that looks through the node's entities.
            return self._executor_thread.ask(lambda: GoalClient(node, action_type, action), _FREE)

        try:
            found: GoalClient = self._use(self._goal_clients, (action_type, action), make, self._drop_goal_client)
        except OtherTypeError:
            wanted = WantedServer(graph.RUNS, full_action_name(self.node, action), type_name(action_type))
            raise not_found(self.node, wanted, 0.0) from None
        return found

    def subscription(
        self, message_type: type[Message], topic: str, callback: Callable[[Message], None], qos: QoSProfile
    ) -> Subscription:
        wanted = type_name(message_type)
        types = types_of(self.node, "/" + str(topic).lstrip("/"))
        if types and wanted not in types:  # nothing could ever arrive; rcl would fail, and not say why
            raise OtherTypeError(f"{topic} has the type {' and '.join(types)}, but you asked for {wanted}.")
        made: Subscription = _named(
            lambda: self.node.create_subscription(message_type, topic, callback, qos), (message_type, topic)
        )
        return made

    def forget(self, channels: set[str]) -> None:
        """Let go of these services, actions and topics, so that they can come back with another type."""
        for key, client in list(self._clients.items()):
            somebody_waits = getattr(client.rclpy_client, "_pending_requests", None)  # a private name; see ros.compat
            if client.name in channels and not somebody_waits:
                self._drop_client(self._clients.pop(key))
        for key in [key for key, publisher in self._publishers.items() if publisher.topic_name in channels]:
            self._drop_publisher(self._publishers.pop(key))
        for key, goal_client in list(self._goal_clients.items()):
            if goal_client.action_name in channels and not goal_client.busy:
                self._drop_goal_client(self._goal_clients.pop(key))

    def forget_all(self) -> None:
        """Let go of all that nobody waits for: a service stands in `ros2 service list` while it has a client."""
        self.forget(
            {client.name for client in self._clients.values()}
            | {publisher.topic_name for publisher in self._publishers.values()}
            | {client.action_name for client in self._goal_clients.values()}
        )

    def destroy(self) -> None:
        self._clients.clear()
        self._publishers.clear()
        while self._goal_clients:
            self._goal_clients.popitem()[1].destroy()
        self._hooks.direct.clear()
        if self.known_node is not None:
            self._executor_thread.executor.remove_node(self.known_node)
            self.known_node.destroy_node()
            self.known_node = None

    def _use(
        self,
        cache: OrderedDict[tuple[Any, str], Any],
        key: tuple[Any, str],
        make: Callable[[], Any],
        drop: Callable[[Any], None],
    ) -> Any:
        found = cache.get(key)
        if found is not None:
            cache.move_to_end(key)
            return found
        for other in [other for other in cache if other[1] == key[1]]:  # the type was defined again
            drop(cache.pop(other))
        cache[key] = entity = _named(make, key)
        if len(cache) > _KEPT:
            drop(cache.popitem(last=False)[1])
        return entity

    def _drop_client(self, client: QueuedClient) -> None:
        self._hooks.direct.discard(client.rclpy_client)
        self._executor_thread.run_between_callbacks(client.destroy, 1.0)

    def _drop_goal_client(self, client: GoalClient) -> None:
        self._executor_thread.run_between_callbacks(client.destroy, 1.0)

    def _drop_publisher(self, publisher: Publisher) -> None:
        self._executor_thread.run_between_callbacks(lambda: self.node.destroy_publisher(publisher), 1.0)


def incompatible(error: BaseException) -> bool:
    """Whether rclpy refused an endpoint because this process uses its name with another type already."""
    return "incompatible type" in error_text(error)


def _named(make: Callable[[], Any], key: tuple[Any, str]) -> Any:
    interface, name = key
    if not isinstance(name, str):
        raise LabError(f"The name comes first and is a string: {name!r} is not. The type comes second.")
    refusals: tuple[type[BaseException], ...] = (*rcl_error(), ValueError)  # the second one from an action client
    try:
        return make()
    except (InvalidServiceNameException, InvalidTopicNameException) as error:
        raise LabError(f"{name!r} is not a ROS name: {str(error).splitlines()[0].rstrip(' :')}.") from error
    except refusals as error:
        if not incompatible(error):
            raise
        raise OtherTypeError(f"{name} is already in use with a different type than {type_name(interface)}.") from error
    except AttributeError as error:  # what rclpy says of a class that is no interface
        raise LabError(f"{type_name(interface)} cannot be used on {name}: {error}") from error


AT_ONCE: int = qos_profile_services_default.depth


class RequestQueue:
    """Lets so many requests be on their way at once; used from any thread."""

    def __init__(self) -> None:
        self._changing = threading.Lock()
        self._under_way: set[object] = set()
        self._waiting: deque[tuple[object, Callable[[], None]]] = deque()

    def enter(self, request: object, send: Callable[[], None]) -> None:
        """Send a request now, or as soon as another one has left."""
        with self._changing:
            if len(self._under_way) >= AT_ONCE:
                self._waiting.append((request, send))
                return
            self._under_way.add(request)
        send()

    def leave(self, request: object) -> None:
        """The request is answered, or nobody waits for it any more; harmless if it has left already."""
        with self._changing:
            if request not in self._under_way:
                self._waiting = deque(one for one in self._waiting if one[0] is not request)
                return
            self._under_way.discard(request)
            follower = self._waiting.popleft() if self._waiting else None
            if follower is not None:
                self._under_way.add(follower[0])
        if follower is not None:
            follower[1]()


class QueuedClient(ServiceClient):
    """A client of one service, with the queue of those who use it."""

    def __init__(self, node: Node, service_type: ServiceType, service: str) -> None:
        super().__init__(node, service_type, service)
        self.queue = RequestQueue()
