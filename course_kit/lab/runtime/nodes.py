"""Which nodes run in the lab, and how a new one takes the place of an old one.

Two servers of one name both run every request, so the first ends before the second begins: a node of the class of the
same name, when that class was defined again or started with equal arguments; any node with the same full name.
"""

from __future__ import annotations

import contextlib
import gc
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionClient, ActionServer

from course_kit.lab.clients import HIDDEN_NAME, name_in_conflict
from course_kit.lab.errors import LabError
from course_kit.lab.runtime.describe import channels_of, is_alive
from course_kit.lab.runtime.failures import without_self
from course_kit.ros.names import full_name

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rclpy.node import Node

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.runtime.executor import ExecutorThread

_BETWEEN_CALLBACKS = 1.0  # seconds a running callback may take before its node is destroyed under it


@dataclass(eq=False)
class LiveNode:
    """A started node."""

    node: Node
    node_class: type
    arguments: tuple[object, ...]
    made: list[Node]  # the node and those that its `__init__` has made
    name: str

    def same_class(self, node_class: type) -> bool:
        mine = self.node_class
        return (mine.__module__, mine.__qualname__) == (node_class.__module__, node_class.__qualname__)

    def precedes(self, node_class: type, arguments: tuple[object, ...]) -> bool:
        if not self.same_class(node_class):
            return False
        return self.node_class is not node_class or _is_equal(self.arguments, arguments)


class Nodes:
    """The live nodes of one lab."""

    def __init__(
        self,
        executor_thread: ExecutorThread,
        end_goals: Callable[[list[Node]], None],
        gone: Callable[[list[Node]], None],
    ) -> None:
        self._executor_thread = executor_thread
        self._end_goals = end_goals
        self._gone = gone
        self.live: tuple[LiveNode, ...] = ()
        self._changing = threading.Lock()
        self._start = threading.local()  # on each thread the nodes `made` so far by the start that is under way

    def __contains__(self, node: object) -> bool:
        return any(live.node is node for live in self.live)

    def watch(self, patches: Patches) -> None:
        """Know each node from its `Node.__init__` on, before it has its name on the graph."""
        from rclpy.node import Node

        original = Node.__init__

        def initialise(node: Node, node_name: str, *arguments: Any, **options: Any) -> None:
            __tracebackhide__ = True  # IPython: the learner's own lines are what matters
            made: list[Node] | None = getattr(self._start, "made", None)
            if made is not None and not str(node_name).startswith(HIDDEN_NAME):
                made.append(node)
                with contextlib.suppress(AttributeError):  # a name that is no string is rclpy's to complain about
                    self._stop_named(full_name(node_name, "/" + (options.get("namespace") or "").strip("/")))
            original(node, node_name, *arguments, **options)

        patches.set(Node, "__init__", initialise)

    def start(self, node_class: type, arguments: tuple[object, ...], options: dict[str, Any]) -> Any:
        """Make a node and run it, in place of the ones it follows."""
        __tracebackhide__ = True  # IPython: the learner's own lines are what matters
        _require_node_class(node_class)
        given = (arguments, options)
        for live in self.live:
            if live.precedes(node_class, given):
                self.stop(live)
        made: list[Node] = []
        self._start.made = made
        try:
            node = node_class(*arguments, **options)
        except BaseException as error:
            self._destroy(made)
            if isinstance(error, AttributeError) and not made:
                raise LabError(_no_super(node_class)) from error
            if isinstance(error, TypeError) and not made and (missing := without_self(node_class, "__init__")):
                raise LabError(f"{error}: {missing}") from None
            if name := name_in_conflict(error):
                raise LabError(self._other_type(node_class, name)) from error
            raise
        finally:
            self._start.made = None
        if not any(node is other for other in made):
            self._destroy(made)
            raise LabError(_no_super(node_class))
        name = node.get_fully_qualified_name()
        self._stop_named(name)  # a remapped name shows only now
        with self._changing:
            self.live = (*self.live, LiveNode(node, node_class, given, made, name))
        self._executor_thread.executor.add_node(node)
        return node

    def find(self, target: object) -> list[LiveNode]:
        """The live nodes meant by a node, a class, or a name with or without its namespace."""
        if isinstance(target, type):
            return [live for live in self.live if live.same_class(target)]
        if isinstance(target, str):
            return [live for live in self.live if target in {live.name, live.name.rpartition("/")[2]}]
        return [live for live in self.live if live.node is target]

    def stop(self, live: LiveNode) -> None:
        """Take a node off the graph, between two callbacks; one that does not end is stopped."""
        with self._changing:
            if live not in self.live:
                return
            self.live = tuple(other for other in self.live if other is not live)
        self._end_goals(live.made)

        def end() -> None:
            self._gone(live.made)
            self._destroy(live.made)

        if not self._executor_thread.run_between_callbacks(end, _BETWEEN_CALLBACKS):
            turn = self._executor_thread.executor.callback_run
            if turn is not None and (turn.node is None or turn.node in live.made):
                self._executor_thread.stop_callback()
            end()

    def stop_soon(self, node: Node) -> None:
        """Stop a node from inside one of its callbacks, once that callback has ended."""
        for live in self.find(node):
            self._executor_thread.executor.create_task(self.stop, live)

    def destroy_all(self) -> None:
        """Destroy every node; for the end of the lab, when no callback runs."""
        for live in self.live:
            self._destroy(live.made)
        self.live = ()

    def _other_type(self, node_class: type, name: str) -> str:
        users = [live.name.lstrip("/") for live in self.live if name in channels_of(live.node)]
        others = f" It is used by {', '.join(sorted(users))}; stop that first." if users else ""
        return f"{node_class.__name__} uses {name} with a different type than the rest of this lab does.{others}"

    def _stop_named(self, name: str) -> None:
        for live in self.live:
            if live.name == name:
                self.stop(live)

    def _destroy(self, nodes: list[Node]) -> None:
        for node in nodes:
            self._executor_thread.executor.remove_node(node)
            _destroy_actions(node)
            # One whose __init__ stopped half-way lacks parts; one that was destroyed already has none left.
            with contextlib.suppress(Exception):
                node.destroy_node()


class NodeList(list[LiveNode]):
    """Live nodes that print as a list of what each offers."""

    others: Sequence[object] = ()

    def __repr__(self) -> str:
        from course_kit.lab.runtime.describe import describe_node

        lines = [describe_node(live.node) for live in self] or ["No node is running in the lab."]
        if self.others:
            lines += ["In other notebooks (lab.stop_others() stops them):", *(f"    {other}" for other in self.others)]
        return "\n".join(lines)


def end_strays(is_stray: Callable[[Node], bool]) -> list[str]:
    """Destroy nodes of this process, wherever they were made; returns their names."""
    from rclpy.node import Node

    ended = []
    for node in [found for found in gc.get_objects() if issubclass(type(found), Node)]:
        if is_alive(node) and not (name := node.get_name()).startswith(HIDDEN_NAME) and is_stray(node):
            _destroy_actions(node)
            with contextlib.suppress(Exception):  # destroyed by hand in part, or made by half when Stop came
                node.destroy_node()
            node.handle.destroy_when_not_in_use()
            ended.append(name)
    return sorted(ended)


def _destroy_actions(node: Node) -> None:
    """Destroy a node's action servers and clients, which `destroy_node` leaves on the graph."""
    for waitable in list(getattr(node, "waitables", ())):
        if isinstance(waitable, (ActionClient, ActionServer)):
            with contextlib.suppress(Exception):  # the learner's code has destroyed it already
                waitable.destroy()


def _is_equal(mine: tuple[object, ...], other: tuple[object, ...]) -> bool:
    try:
        return bool(mine == other)
    except Exception:  # noqa: BLE001 - arrays and other values whose comparison is no truth value
        return False


def _require_node_class(given: object) -> None:
    from rclpy.node import Node

    if isinstance(given, type) and issubclass(given, Node):
        return
    if isinstance(given, Node):
        raise LabError(
            f"Pass the class, not a node made from it: lab.start({type(given).__name__}). The lab makes the node, "
            "so that it can replace an older one."
        )
    name = getattr(given, "__name__", repr(given))
    raise LabError(f"{name} is not a class of nodes; lab.start takes a class that inherits from rclpy.node.Node.")


def _no_super(node_class: type) -> str:
    return (
        f"{node_class.__name__}.__init__ has to call super().__init__('a_node_name') before anything else: "
        "that is what makes it a ROS node."
    )
