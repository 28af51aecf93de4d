"""The grader's own node: a context, a node and an executor on one thread, in one ROS domain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rclpy.client import Client

NAME = "_course_kit_grader"  # hidden from `ros2 node list`, as names with an underscore are


@dataclass(frozen=True)
class Offer:
    """A service somebody on the graph offers."""

    name: str
    type: str
    node: str


class Tester:
    """The grader on the graph. Its own endpoints never appear in what it reports."""

    def __init__(self, domain: int | None) -> None:
        """Join the graph of `domain`, or of ROS_DOMAIN_ID when None."""
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain, signal_handler_options=SignalHandlerOptions.NO)
        self.node = Node(
            NAME,
            context=self._context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._clients: dict[tuple[str, int], Client] = {}

    @property
    def domain(self) -> int:
        """The ROS domain it is in."""
        return int(self._context.get_domain_id())

    def spin_once(self, timeout_s: float) -> None:
        """Run one callback, or wait for one at most `timeout_s` seconds."""
        if not self._context.ok():
            raise ExternalShutdownException
        self._executor.spin_once(timeout_sec=timeout_s)

    def client(self, interface: Any, name: str, number: int = 0) -> Client:
        """The client `number` of a service; made on first use and kept, so that it is connected the next time."""
        key = (name, number)
        if key not in self._clients:
            self._clients[key] = self.node.create_client(interface, name)
        return self._clients[key]

    def nodes(self) -> list[str]:
        """Full names of all other nodes; a name stands as often as nodes carry it."""
        return sorted(f"{space.rstrip('/')}/{name}" for name, space in self._others())

    def services(self) -> list[Offer]:
        """The services that other nodes offer, but for those every node has for its parameters."""
        found = []
        for name, space in self._others():
            node = f"{space.rstrip('/')}/{name}"
            try:
                offered = self.node.get_service_names_and_types_by_node(name, space)
            except Exception:  # noqa: BLE001, S112 - NodeNameNonExistentError or RCLError: it has just left the graph
                continue
            found += [Offer(service, kind, node) for service, kinds in offered for kind in kinds]
        return [offer for offer in found if not _is_for_parameters(offer)]

    def close(self) -> None:
        """Leave the graph. Safe to call twice."""
        if self._context.ok():
            self._executor.shutdown(timeout_sec=0)
            self.node.destroy_node()
            self._context.try_shutdown()

    def _others(self) -> Iterator[tuple[str, str]]:
        return ((name, space) for name, space in self.node.get_node_names_and_namespaces() if name != NAME)


def _is_for_parameters(offer: Offer) -> bool:
    return offer.type.startswith(("rcl_interfaces/srv/", "type_description_interfaces/srv/"))
