"""Two nodes of one executor, which the test spins until something is so."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

if TYPE_CHECKING:
    from collections.abc import Callable

PATIENCE = 60.0


class TwoNodes:
    """The nodes.

    Args:
        domain_id: where they meet.
        names: what they are called.
    """

    def __init__(self, domain_id: int, names: tuple[str, str]) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain_id)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.nodes = [Node(name, context=self.context) for name in names]
        for node in self.nodes:
            self.executor.add_node(node)

    def spin_until(self, is_true: Callable[[], bool]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not is_true():
            assert time.monotonic() < deadline
            self.executor.spin_once(timeout_sec=0.1)

    def close(self) -> None:
        self.executor.shutdown(timeout_sec=0)
        self.context.try_shutdown()
