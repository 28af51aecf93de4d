"""Nodes of a test, which spins them while it waits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.executors import SingleThreadedExecutor

if TYPE_CHECKING:
    from collections.abc import Callable

DEADLINE = 30.0  # seconds; only against hanging


class Spun:
    """Nodes in one process, spun while a test waits.

    Args:
        domain: the ROS domain.
        names: of the nodes.
    """

    def __init__(self, domain: int, *names: str) -> None:
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.nodes = [rclpy.create_node(name, context=self.context, enable_rosout=False) for name in names]
        self.executor = SingleThreadedExecutor(context=self.context)
        for node in self.nodes:
            self.executor.add_node(node)

    @property
    def node(self) -> Any:
        """The first node."""
        return self.nodes[0]

    def wait_for(self, condition: Callable[[], Any], what: str) -> None:
        clock = self.node.get_clock()
        end = clock.now().nanoseconds + DEADLINE * 1e9
        while not condition():
            assert clock.now().nanoseconds < end, f"waited {DEADLINE} s for {what}"
            self.executor.spin_once(timeout_sec=0.05)

    def answer(self, client: Any, request: Any) -> Any:
        self.wait_for(client.service_is_ready, client.srv_name)
        future = client.call_async(request)
        self.wait_for(future.done, f"an answer of {client.srv_name}")
        return future.result()

    def close(self) -> None:
        self.executor.shutdown()
        for node in self.nodes:
            node.destroy_node()
        rclpy.shutdown(context=self.context)
