"""The command's own place on the graph: a node when a verb needs one, gone when the command ends."""

from __future__ import annotations

import os
import re
import sys
import time
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.node import Node

    from course_kit.ros.messages import Message
    from course_kit.ros.service import ServiceClient
    from course_kit.ros2cli.graph import Graph

_SPIN = 0.05  # seconds in C between two looks for a Ctrl-C
_LOOK_EVERY = 0.003
_GENERATOR = "rosidl_generator_py.generate_py_impl"
_LAST_WORDS = 0.5  # seconds for an answer that was under way when its server left


class CommandError(Exception):
    """A verb cannot do what was asked; the message is the one line that goes to stderr."""

    def __init__(self, message: str) -> None:
        super().__init__(" ".join(message.split()))


class Session:
    """What one command shares between its steps."""

    def __init__(
        self, context: Context | None = None, guests: set[Node] | None = None, *, visits: bool = False
    ) -> None:
        self.in_kernel = context is not None
        self._context = context
        self._visits = visits
        self._guests = set() if guests is None else guests
        self._own: tuple[Node, Executor] | None = None
        self._name = f"_ros2cli_{os.getpid()}"

    @property
    def has_node(self) -> bool:
        """Whether this command is on the graph already."""
        return self._own is not None

    @property
    def node(self) -> Node:
        """The command's hidden node, made on first use, without services."""
        return self._spun_node()[0]

    def call_node(self, name: str) -> None:
        """Give the command's node a name of the user's, before it is made."""
        if not re.fullmatch(r"[A-Za-z_]\w*", name):
            raise CommandError(
                f"{name!r} cannot be a node's name: it begins with a letter, then letters, digits and _."
            )
        self._name = name

    def observe(self, patience: float) -> Graph:
        """The graph as this process sees it, settled."""
        from course_kit.ros2cli.observe import open_observer

        name = f"_ros2cli_{os.getpid()}_looking"
        with open_observer(self._own_context(), name=name, visits=self._visits) as looking:
            return looking.graph(patience)

    def spin_until(self, is_done: Callable[[], bool], timeout: float) -> bool:
        """Run the node's callbacks until `is_done`; False when `timeout` seconds have passed first."""
        deadline = time.monotonic() + timeout
        _, executor = self._spun_node()
        while not is_done():
            left = deadline - time.monotonic()
            if left <= 0:
                return False
            executor.spin_once(timeout_sec=min(left, _SPIN))
        return True

    def answer_of(self, client: ServiceClient, request: Message, timeout: float, server: str) -> Message:
        """What a service that is there answers within `timeout` seconds."""
        sent = client.send(request)
        self.spin_until(lambda: sent.is_answered() or not client.is_ready(), timeout)
        if not sent.is_answered() and not client.is_ready() and not self.spin_until(sent.is_answered, _LAST_WORDS):
            raise CommandError(
                f"{server} went away before it answered: its program has ended. Its own output says why; an exception "
                "in a callback does that."
            )
        if not sent.is_answered():
            raise CommandError(
                f"{server} has not answered within {timeout:g} s. Is its callback still running, has it raised an "
                "exception, or is its node not spinning? Its own output may say. A longer wait: --timeout SECONDS."
            )
        try:
            return sent.response()
        except Exception as error:  # what a lab says of a callback that has failed
            raise CommandError(str(error)) from error

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
        if self._own is not None:
            node, executor = self._own
            self._guests.discard(node)
            executor.shutdown()
            node.destroy_node()
        if not self.in_kernel and self._context is not None:
            self._context.try_shutdown()

    def _spun_node(self) -> tuple[Node, Executor]:
        if self._own is None:
            from rclpy.executors import SingleThreadedExecutor

            from course_kit.environment.visitor import visit_graph
            from course_kit.ros.graph import quiet_node

            context = self._own_context()
            with visit_graph(self._visits):
                made = quiet_node(self._name, context)
            self._own = made, SingleThreadedExecutor(context=context)
            node, executor = self._own
            executor.add_node(node)
            self._guests.add(node)
        return self._own

    def _own_context(self) -> Context:
        if self._context is None:
            from course_kit import environment

            environment.apply_settings()  # before rclpy, also where the autoload is turned off
            _leave_out_the_generator()
            import rclpy

            self._context = rclpy.Context()
            self._context.init([])
        return self._context


def _leave_out_the_generator() -> None:
    """Import rclpy's type support without the generator of message classes, which reads grammars at its import."""
    if _GENERATOR not in sys.modules:
        sys.modules[_GENERATOR] = ModuleType(_GENERATOR)  # without `generate_py`: an ImportError for those who ask
