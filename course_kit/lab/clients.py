"""The lab's own hidden node, with a client for each service and action and a publisher for each topic it has used."""

from __future__ import annotations

import os
import threading
import time
from collections import OrderedDict
from typing import TYPE_CHECKING, Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.validate_topic_name import validate_topic_name

from course_kit.lab.errors import ActionNotFoundError, LabError, ServiceNotFoundError
from course_kit.lab.graph import WantedServer, not_offered
from course_kit.ros import graph
from course_kit.ros.compat import rcl_error
from course_kit.ros.goal import GoalClient
from course_kit.ros.messages import type_name
from course_kit.ros.names import full_action_name
from course_kit.ros.node import quiet_node

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.recording.hooks import Tapping
    from course_kit.lab.runtime.executor_thread import Spinner

HIDDEN_NAME = "_lab_"  # and the process's number, so that two notebooks do not share it
_POLL = 0.005  # seconds
_FREE = 1.0  # seconds in which the lab's thread must be free to make a client
_KEPT = 32  # clients and publishers; the one unused for longest goes first


class OtherTypeError(LabError):
    """A name is in use in this lab with another type."""


class Clients:
    """What the lab speaks through.

    Args:
        spinner: runs the node.
        tapping: told that these clients are the lab's.
        alias: the node's name in recordings.
    """

    def __init__(self, spinner: Spinner, tapping: Tapping, alias: str) -> None:
        self._spinner = spinner
        self._tapping = tapping
        self._alias = alias
        self._clients: OrderedDict[tuple[Any, str], Any] = OrderedDict()
        self._publishers: OrderedDict[tuple[Any, str], Any] = OrderedDict()
        self._goal_clients: OrderedDict[tuple[Any, str], GoalClient] = OrderedDict()
        self.known_node: Any = None

    @property
    def node(self) -> Any:
        """The node, made on first use. The underscore in its name hides it from `ros2 node list`."""
        if self.known_node is None:
            node = quiet_node(f"{HIDDEN_NAME}{os.getpid()}", self._spinner.context)
            self._tapping.aliases[node.get_fully_qualified_name()] = self._alias
            self._spinner.executor.add_node(node)
            self.known_node = node
        return self.known_node

    def client(self, service_type: Any, service: str) -> Any:
        """The client for a service; one of the same name and another type is replaced.

        Raises:
            ServiceNotFoundError: no server of this name and type.
        """

        def make() -> Any:
            client = self.node.create_client(service_type, service, callback_group=ReentrantCallbackGroup())
            self._tapping.direct.add(client)
            return client

        try:
            return self._use(self._clients, (service_type, service), make, self._drop_client)
        except OtherTypeError:
            wanted = WantedServer(graph.SERVES, self.node.resolve_service_name(service), type_name(service_type))
            own = frozenset({self.node.get_fully_qualified_name()})
            raise ServiceNotFoundError(not_offered(self.node, wanted, 0.0, own)) from None

    def publisher(self, message_type: Any, topic: str) -> Any:
        """The publisher for a topic; one of the same name and another type is replaced."""

        def make() -> Any:
            return self.node.create_publisher(message_type, topic, 10)

        return self._use(self._publishers, (message_type, topic), make, self._drop_publisher)

    def goal_client(self, action_type: Any, action: str) -> GoalClient:
        """The client for an action; one of the same name and another type is replaced.

        Raises:
            ActionNotFoundError: no server of this name and type.
        """

        def make() -> Any:
            node = self.node
            validate_topic_name(action)
            types = graph.offered(node, graph.RUNS).get(full_action_name(node, action), [])
            if types and type_name(action_type) not in types:  # rclpy would make half a client, and lose it
                raise OtherTypeError(f"{action} is already in use with a different type than {type_name(action_type)}.")
            # On the thread that will use it, and not while that looks through the node's entities.
            return self._spinner.ask(lambda: GoalClient(node, action_type, action), _FREE)

        try:
            found: GoalClient = self._use(self._goal_clients, (action_type, action), make, self._drop_goal_client)
        except OtherTypeError:
            wanted = WantedServer(graph.RUNS, full_action_name(self.node, action), type_name(action_type))
            raise ActionNotFoundError(not_offered(self.node, wanted, 0.0)) from None
        return found

    def wait_for_results(self, actions: set[str], timeout: float) -> None:
        """Wait until no goal of these actions is on its way; `timeout` seconds at most."""
        deadline = time.monotonic() + timeout
        pause = threading.Event()
        clients = [client for client in self._goal_clients.values() if client.action_name in actions]
        while any(client.busy for client in clients) and time.monotonic() < deadline:
            pause.wait(_POLL)

    def subscription(self, message_type: Any, topic: str, callback: Callable[[Any], None], qos: Any) -> Any:
        """A new subscription.

        Args:
            message_type: its class.
            topic: its name.
            callback: called with each message.
            qos: the profile.

        Raises:
            LabError: the topic is no ROS name, or has another type on the graph.
        """
        wanted = type_name(message_type)
        types = dict(self.node.get_topic_names_and_types()).get("/" + str(topic).lstrip("/"), [wanted])
        if wanted not in types:  # nothing could ever arrive; in one process rcl would fail, and say nothing useful
            raise OtherTypeError(f"{topic} has the type {' and '.join(types)}, but you asked for {wanted}.")
        return _named(lambda: self.node.create_subscription(message_type, topic, callback, qos), (message_type, topic))

    def forget(self, channels: set[str]) -> None:
        """Let go of these services, actions and topics, so that they can come back with another type."""
        for key, client in list(self._clients.items()):
            somebody_waits = getattr(client, "_pending_requests", None)  # a private name; see ros.compat
            if client.service_name in channels and not somebody_waits:
                self._drop_client(self._clients.pop(key))
        for key in [key for key, publisher in self._publishers.items() if publisher.topic_name in channels]:
            self._drop_publisher(self._publishers.pop(key))
        for key, goal_client in list(self._goal_clients.items()):
            if goal_client.action_name in channels and not goal_client.busy:
                self._drop_goal_client(self._goal_clients.pop(key))

    def destroy(self) -> None:
        """Destroy the node and all that is on it."""
        self._clients.clear()
        self._publishers.clear()
        while self._goal_clients:
            self._goal_clients.popitem()[1].destroy()
        self._tapping.direct.clear()
        if self.known_node is not None:
            self._spinner.executor.remove_node(self.known_node)
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

    def _drop_client(self, client: Any) -> None:
        self._tapping.direct.discard(client)
        self._spinner.run_between_callbacks(lambda: self.node.destroy_client(client), 1.0)

    def _drop_goal_client(self, client: GoalClient) -> None:
        """Destroy an action's client; goals that have not ended have lost their server, or their server its type."""

        def drop() -> None:
            for pursuit in list(client.busy.values()):
                pursuit.lose()
            client.destroy()

        self._spinner.run_between_callbacks(drop, 1.0)

    def _drop_publisher(self, publisher: Any) -> None:
        self._spinner.run_between_callbacks(lambda: self.node.destroy_publisher(publisher), 1.0)


def incompatible(error: BaseException) -> bool:
    """Whether rclpy refused an endpoint because this process uses its name with another type already.

    Fast DDS keeps one type for each topic name in a participant, and a lab has one participant.
    """
    return "incompatible type" in str(error)


def _named(make: Callable[[], Any], key: tuple[Any, str]) -> Any:
    interface, name = key
    if not isinstance(name, str):
        raise LabError(f"The name comes first and is a string: {name!r} is not. The type comes second.")
    try:
        return make()
    except (InvalidServiceNameException, InvalidTopicNameException) as error:
        raise LabError(f"{name!r} is not a ROS name: {str(error).splitlines()[0].rstrip(' :')}.") from error
    except (rcl_error(), ValueError) as error:  # the second one from an action client
        if not incompatible(error):
            raise
        raise OtherTypeError(f"{name} is already in use with a different type than {type_name(interface)}.") from error
    except AttributeError as error:  # what rclpy says of a class that is no interface
        raise LabError(f"{type_name(interface)} cannot be used on {name}: {error}") from error
