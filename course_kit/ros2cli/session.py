"""The command's own place on the graph: a node when a verb needs one, gone when the command ends."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING, Any

from course_kit.ros2cli.errors import CommandError

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.ros2cli.graph import Graph

_SPIN = 0.05  # seconds in C between two looks for a Ctrl-C
_LOOK_EVERY = 0.003
_LAST_WORDS = 0.5  # seconds for an answer that was under way when its server left


class Session:
    """What one command shares between its steps.

    Args:
        context: rclpy context of a kernel to work in; None for one of the command's own.
        guests: where a kernel's lab looks for nodes that wait for its services, besides its own; it then tells them
            when a callback fails.
    """

    def __init__(self, context: Any = None, guests: set[Any] | None = None) -> None:
        self.in_kernel = context is not None
        self._context = context
        self._guests = set() if guests is None else guests
        self._node: Any = None
        self._executor: Any = None

    @property
    def has_node(self) -> bool:
        """Whether this command is on the graph already."""
        return self._node is not None

    @property
    def node(self) -> Any:
        """The command's hidden node, made on first use, without services of its own."""
        if self._node is None:
            from rclpy.executors import SingleThreadedExecutor

            from course_kit.ros.node import quiet_node

            self._node = quiet_node(f"_ros2cli_{os.getpid()}", self._own_context())
            self._executor = SingleThreadedExecutor(context=self._context)
            self._executor.add_node(self._node)
            self._guests.add(self._node)
        return self._node

    def observe(self, patience: float) -> Graph:
        """The graph as this process sees it, settled."""
        from course_kit.ros2cli.observe import observer

        with observer(self._own_context(), name=f"_ros2cli_{os.getpid()}_looking") as looking:
            return looking.graph(patience)

    def spin_until(self, is_done: Callable[[], bool], timeout: float) -> bool:
        """Run the node's callbacks until `is_done`; False when `timeout` seconds have passed first."""
        deadline = time.monotonic() + timeout
        while not is_done():
            left = deadline - time.monotonic()
            if left <= 0:
                return False
            self._executor.spin_once(timeout_sec=min(left, _SPIN))
        return True

    def result_of(self, future: Any, timeout: float, missing: str) -> Any:
        """What a future brings within `timeout` seconds.

        Args:
            future: what is waited for.
            timeout: in seconds.
            missing: what to say when nothing comes.

        Raises:
            CommandError: it did not come; the message is `missing`.
        """
        if not self.spin_until(future.done, timeout):
            raise CommandError(missing)
        if error := future.exception():
            raise CommandError(str(error)) from error
        return future.result()

    def answer_of(self, client: Any, request: Any, timeout: float, server: str) -> Any:
        """What a service that is there answers within `timeout` seconds; `server` is what to call it.

        Args:
            client: of the service.
            request: what is asked.
            timeout: in seconds.
            server: what to call the server.

        Raises:
            CommandError: no answer came, or none can come any more.
        """
        future = client.call_async(request)
        self.spin_until(lambda: future.done() or not client.service_is_ready(), timeout)
        if not future.done() and not client.service_is_ready():
            gone = (
                f"{server} went away before it answered: its program has ended. Its own output says why; an exception "
                "in a callback does that."
            )
            return self.result_of(future, _LAST_WORDS, gone)
        silent = (
            f"{server} has not answered within {timeout:g} s. Is its callback still running, has it raised an "
            "exception, or is its node not spinning? Its own output may say. A longer wait: --timeout SECONDS."
        )
        return self.result_of(future, 0.0, silent)

    def wait_on_graph(self, is_true: Callable[[], bool], timeout: float) -> bool:
        """Wait for something on the graph, which has no events in rclpy; False when it took longer than `timeout`."""
        deadline = time.monotonic() + timeout
        while not is_true():
            if time.monotonic() > deadline:
                return False
            time.sleep(_LOOK_EVERY)
        return True

    def close(self) -> None:
        """Leave the graph."""
        if self._node is not None:
            self._guests.discard(self._node)
            self._executor.shutdown()
            self._node.destroy_node()
        if not self.in_kernel and self._context is not None:
            self._context.try_shutdown()

    def _own_context(self) -> Any:
        if self._context is None:
            from course_kit import environment

            environment.apply()  # before rclpy, also where the autoload is turned off
            import rclpy

            self._context = rclpy.Context()
            self._context.init([])
        return self._context
