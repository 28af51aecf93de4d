"""The lab's own hidden node, with a client for each service and action and a publisher for each topic it has used."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any, NamedTuple

from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.validate_topic_name import validate_topic_name

from course_kit.lab.errors import ActionNotFoundError, LabError, ServiceNotFoundError, error_text
from course_kit.ros import graph
from course_kit.ros.goal import GoalClient
from course_kit.ros.graph import quiet_node
from course_kit.ros.messages import type_name
from course_kit.ros.names import full_action_name, is_hidden, is_of_every_node, nearest_name
from course_kit.ros.service import ServiceClient

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
_FREE = 1.0  # seconds in which the lab's thread must be free to make a client


class WantedServer(NamedTuple):
    """A server that was looked for."""

    role: graph.Role
    name: str
    type: str


def not_found(node: Node, wanted: WantedServer, waited: float, except_by: frozenset[str] = frozenset()) -> LabError:
    """The error that says why no such server was found, and what to do."""
    role, name, wanted_type = wanted
    kind = ServiceNotFoundError if role == graph.SERVES else ActionNotFoundError
    offered = graph.offered_types(node, role, except_by)
    there = {name: types for name, types in offered.items() if not (is_of_every_node(name) or is_hidden(name))}
    types = there.get(name)
    if types and wanted_type not in types:
        asked = "you called it with" if role == graph.SERVES else "the goal was one of"
        return kind(
            f"{name} has the type {' and '.join(sorted(types))}, but {asked} {wanted_type}. "
            "Client and server must use the same type."
        )
    message = f"No node {role.verb} {name} (waited {waited:g} s). "
    if near := nearest_name(name, there):
        return kind(f"{message}The nearest name on the graph is {near} [{', '.join(sorted(there[near]))}].")
    if there:
        return kind(f"{message}On the graph: {', '.join(sorted(there)[:5])}.")
    common = " but those that every node has" if role == graph.SERVES else ""
    return kind(f"{message}No {role.kind} is on the graph{common}: has its server been started?")


class OtherTypeError(LabError):
    """A name is in use in this lab with another type."""


class Clients:
    """What the lab speaks through; each is kept for the next time."""

    def __init__(self, executor_thread: ExecutorThread, hooks: MessageHooks) -> None:
        self._executor_thread = executor_thread
        self._hooks = hooks
        self._made: dict[tuple[str, str, Any], Any] = {}  # by what it is for, its name as it was given, and the type
        self._node: Node | None = None

    @property
    def node(self) -> Node:
        """The node, made on first use. The underscore in its name hides it from `ros2 node list`."""
        if self._node is None:
            node = quiet_node(f"{HIDDEN_NAME}{os.getpid()}", self._executor_thread.context)
            self._hooks.aliases[node.get_fully_qualified_name()] = LAB_NAME
            self._hooks.own_nodes.add(node)
            self._executor_thread.executor.add_node(node)
            self._node = node
        return self._node

    def client(self, service_type: ServiceType, service: str) -> ServiceClient:
        """The client for a service; one of the same name and another type is replaced."""

        def make() -> ServiceClient:
            client = ServiceClient(self.node, service_type, service)
            self._hooks.direct.add(client.rclpy_client)
            return client

        try:
            found: ServiceClient = self._find_or_make("service", service, service_type, make)
        except OtherTypeError:
            raise self._not_found(graph.SERVES, self.node.resolve_service_name(service), service_type) from None
        return found

    def publisher(self, message_type: type[Message], topic: str) -> Publisher:
        """The publisher for a topic; one of the same name and another type is replaced."""
        found: Publisher = self._find_or_make(
            "topic", topic, message_type, lambda: self.node.create_publisher(message_type, topic, 10)
        )
        return found

    def goal_client(self, action_type: ActionType, action: str) -> GoalClient:
        """The client for an action; one of the same name and another type is replaced."""

        def make() -> GoalClient:
            node = self.node
            validate_topic_name(action)
            types = graph.offered_types(node, graph.RUNS).get(full_action_name(node, action), [])
            if types and type_name(action_type) not in types:  # rclpy would make half a client, and lose it
                raise OtherTypeError(f"{action} is already in use with a different type than {type_name(action_type)}.")
            # On the thread that will use it, and not while that looks through the node's entities.
            return self._executor_thread.ask(lambda: GoalClient(node, action_type, action), _FREE)

        try:
            found: GoalClient = self._find_or_make("action", action, action_type, make)
        except OtherTypeError:
            raise self._not_found(graph.RUNS, full_action_name(self.node, action), action_type) from None
        return found

    def subscription(
        self, message_type: type[Message], topic: str, callback: Callable[[Message], None], qos: QoSProfile
    ) -> Subscription:
        wanted = type_name(message_type)
        types = dict(self.node.get_topic_names_and_types()).get("/" + str(topic).lstrip("/"), [])
        if types and wanted not in types:  # nothing could ever arrive; rcl would fail, and not say why
            raise OtherTypeError(f"{topic} has the type {' and '.join(types)}, but you asked for {wanted}.")
        made: Subscription = _check_name(
            lambda: self.node.create_subscription(message_type, topic, callback, qos), message_type, topic
        )
        return made

    def forget(self, channels: set[str] | None = None) -> None:
        """Let go of these services, actions and topics, or of all, so that they can come back with another type.

        A service stands in `ros2 service list` while it has a client. What somebody waits for stays.
        """
        for key, entity in list(self._made.items()):
            if (channels is None or _full_name(entity) in channels) and not getattr(entity, "busy", False):
                self._drop(key)

    def destroy(self) -> None:
        for entity in self._made.values():
            if isinstance(entity, GoalClient):
                entity.destroy()
        self._made.clear()
        if self._node is not None:
            self._executor_thread.executor.remove_node(self._node)
            self._node.destroy_node()
            self._node = None

    def _not_found(self, role: graph.Role, name: str, interface: Any) -> LabError:
        wanted = WantedServer(role, name, type_name(interface))
        return not_found(self.node, wanted, 0.0, frozenset({self.node.get_fully_qualified_name()}))

    def _find_or_make(self, kind: str, name: str, interface: Any, make: Callable[[], Any]) -> Any:
        key = (kind, name, interface)
        if key not in self._made:
            for other in [other for other in self._made if other[:2] == key[:2]]:  # the type was defined again
                self._drop(other)
            self._made[key] = _check_name(make, interface, name)
        return self._made[key]

    def _drop(self, key: tuple[str, str, Any]) -> None:
        entity = self._made.pop(key)
        destroy = (lambda: self.node.destroy_publisher(entity)) if key[0] == "topic" else entity.destroy
        self._executor_thread.run_between_callbacks(destroy, 1.0)


def _full_name(entity: ServiceClient | GoalClient | Publisher) -> str:
    if isinstance(entity, GoalClient):
        return entity.action_name
    return entity.name if isinstance(entity, ServiceClient) else entity.topic_name


def name_in_conflict(error: BaseException) -> str:
    """The name that rclpy refused because this process uses it with another type already; "" for any other error."""
    text = error_text(error)
    if "incompatible type" not in text:
        return ""
    found = re.search(r"topic name r[tqr](?P<name>/\S+?)(/_action/\w+)?(Request|Reply)? with", text)
    return found["name"] if found else "a service or topic"


def _check_name(make: Callable[[], Any], interface: Any, name: str) -> Any:
    if not isinstance(name, str):
        raise LabError(f"The name comes first and is a string: {name!r} is not. The type comes second.")
    refusals = (getattr(rclpy_implementation, "RCLError", ValueError), ValueError)  # the second from an action client
    try:
        return make()
    except (InvalidServiceNameException, InvalidTopicNameException) as error:
        raise LabError(f"{name!r} is not a ROS name: {str(error).splitlines()[0].rstrip(' :')}.") from error
    except refusals as error:
        if not name_in_conflict(error):
            raise
        raise OtherTypeError(f"{name} is already in use with a different type than {type_name(interface)}.") from error
    except AttributeError as error:  # what rclpy says of a class that is no interface
        raise LabError(f"{type_name(interface)} cannot be used on {name}: {error}") from error
