"""The running half of a lab: made when ROS is first needed, ended once.

It puts the parts together: the executor's thread and its nodes, the overrides of rclpy's functions, the client side of
calls, and what to say when a callback fails.
"""

from __future__ import annotations

import asyncio
import contextlib
import sys
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple

import rclpy.utilities
from rclpy.action import ActionServer
from rclpy.task import Future

from course_kit.lab.clients import Clients
from course_kit.lab.errors import CallbackStopped, DeadlockError
from course_kit.lab.overrides import callbacks, rclpy_functions
from course_kit.lab.overrides.patches import Patches, quieten_finalizers
from course_kit.lab.recording.action_hooks import hook_execution
from course_kit.lab.recording.hooks import MessageHooks
from course_kit.lab.runtime import actions, nodes
from course_kit.lab.runtime.callback_errors import where_is
from course_kit.lab.runtime.describe import actions_of
from course_kit.lab.runtime.execution import Executions, abort_goals, turn_of
from course_kit.lab.runtime.executor import Turn
from course_kit.lab.runtime.executor_thread import ExecutorThread
from course_kit.lab.runtime.failures import Failures
from course_kit.lab.runtime.neighbours import Neighbours
from course_kit.lab.runtime.nodes import Nodes
from course_kit.ros import compat

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Sequence

    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.subscription import Subscription

    from course_kit.lab.notebook.cells import Notebook
    from course_kit.lab.notebook.output import Output
    from course_kit.lab.recording.events import EventStream
    from course_kit.lab.runtime.callback_errors import Locate
    from course_kit.lab.runtime.nodes import LiveNode
    from course_kit.ros.compat import Compatibility
    from course_kit.ros.messages import Message


def as_asyncio(future: Future) -> asyncio.Future[Any]:
    """The running loop's future that follows an rclpy future; cancelling it cancels that one."""
    loop = asyncio.get_running_loop()
    follower = loop.create_future()

    def follow() -> None:
        if follower.done():
            return
        if future.cancelled():
            follower.cancel()
        elif future.exception() is not None:
            follower.set_exception(future.exception())
        else:
            follower.set_result(future.result())

    def completed(_: object) -> None:
        with suppress(RuntimeError):  # the loop is closed: nobody waits
            loop.call_soon_threadsafe(follow)

    def forward_cancel(waited: asyncio.Future[Any]) -> None:
        if waited.cancelled():
            future.cancel()

    future.add_done_callback(completed)
    follower.add_done_callback(forward_cancel)
    return follower


def install(patches: Patches, before_waiting: Callable[[Future], None], after_waiting: Callable[[], None]) -> None:
    """Replace `Future.__await__`."""
    original = Future.__await__

    def awaited(future: Future) -> Generator[Any, None, Any]:
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            before_waiting(future)
            return (yield from original(future))
        try:
            return (yield from as_asyncio(future).__await__())
        finally:
            after_waiting()

    patches.set(Future, "__await__", awaited)


LAB_NAME = "lab"
_FREE = 1.0  # seconds a callback may keep the thread before goals are not ended properly
_TOLD = 0.5  # seconds the lab's own clients are given to hear that their goals were aborted
_JOIN = 0.5  # seconds an execute callback is given to end when its node is stopped; later it ends unseen
_LAST_JOIN = 2.0  # the same at the end of the lab


class Engine:
    """Everything of a lab that needs rclpy."""

    def __init__(self, events: EventStream, output: Output, notebook: Notebook, found: Compatibility) -> None:
        self.output = output
        self.on_server_gone: Callable[[], None] = lambda: None
        self.guests: set[Node] = set()
        self.spinning: set[Executor] = set()  # the learner's own executors that run at this moment
        self._noted: set[str] = set()
        self._locate = notebook.locate
        self._found = found
        self._notebook = notebook
        self._patches = Patches()
        self._hooks = MessageHooks(events)
        self._failures = Failures(output, notebook.locate, self._hooks, self)
        self.executor_thread = ExecutorThread(notebook.ros_arguments(found), self._hooks, self._failures, found)
        self.executions = Executions(self.executor_thread.executor, output)
        self.nodes = Nodes(self.executor_thread, self._end_goals, self._forget)
        self.clients = Clients(self.executor_thread, self._hooks, LAB_NAME)
        self._install()
        self.neighbours = Neighbours(self, notebook.title)

    def _install(self) -> None:
        quieten_finalizers(self._patches)
        rclpy_functions.install(self._patches, self)
        callbacks.install(self._patches, self._locate)
        if self._found.has(compat.WAITING_FOR_GOALS):
            rclpy_functions.guard_goals(self._patches, self)
        if self._found.has(compat.GOAL_RECORDING):
            from course_kit.lab.recording.action_hooks import ActionHooks

            ActionHooks(self._hooks, self._patches)  # before the sending of goals is held back
        if self._found.has(compat.EXECUTIONS):
            actions.execute_apart(self._patches, self.executions, self._failures.callback_crashed)
            actions.answer_for_broken_ones(self._patches, self._failures.callback_crashed)
            hook_execution(self._patches, self._hooks)  # after it, so that it sees the thread of the callback itself
        if self._found.has(compat.WAITING_FOR_GOALS):
            actions.keep_replies(self._patches)
        self.nodes.watch(self._patches)
        if self._found.has(compat.RECORDING):
            self._hooks.hook_sending(self._patches)
        install(self._patches, self._check_await, self.flush_output)
        if self._found.has(compat.DEFAULT_CONTEXT):
            # Nodes that pass no context, and rclpy.ok(), use the default one.
            self._patches.set(rclpy.utilities, "g_default_context", self.executor_thread.context)

    def _check_await(self, future: Future) -> None:
        if self._found.has(compat.PENDING_CALLS):
            rclpy_functions.check_await(self, future)

    def close(self) -> bool:
        """End everything; False if a callback could not be ended."""
        self._end_goals([live.node for live in self.nodes], _LAST_JOIN)
        try:
            return self.executor_thread.close(self._destroy_nodes)
        finally:
            self._patches.undo()

    def _destroy_nodes(self) -> None:
        self.nodes.destroy_all()
        self.clients.destroy()

    # What calls and goals ask

    @property
    def node(self) -> Node:
        """The lab's own, hidden node."""
        return self.clients.node

    @property
    def own_names(self) -> frozenset[str]:
        """The fully qualified names of the lab's own nodes."""
        return frozenset({self.clients.node.get_fully_qualified_name()})

    def destroy_subscription(self, subscription: Subscription) -> None:
        """Destroy a subscription of the lab's node."""
        self.executor_thread.run_between_callbacks(lambda: self.node.destroy_subscription(subscription), 1.0)

    def subscriptions(self, topic: str, message_type: object) -> set[Subscription]:
        """The subscriptions of the lab's nodes to a topic, and its own."""
        nodes = [*(live.node for live in self.nodes), *filter(None, [self.clients.known_node])]
        return {
            one
            for node in nodes
            for one in node.subscriptions
            if one.topic_name == topic and one.msg_type is message_type
        }

    def tells_deliveries(self) -> bool:
        """Whether a subscription that has had a message can be known."""
        return self._found.has(compat.RECORDING)

    def listen_for_deliveries(self, told: Callable[[Subscription], None], *, listen: bool) -> None:
        """Begin or end to call `told` with each subscription whose callback has had a message."""
        (self._hooks.on_delivery.add if listen else self._hooks.on_delivery.discard)(told)

    def do(self, function: Callable[[], None]) -> None:
        """Have the lab's thread call a function between two callbacks; does not wait for it."""
        self.executor_thread.executor.create_task(function)

    def call_back(self, function: Callable[[], object]) -> None:
        """Call a function of the learner's on the lab's thread; what it raises is told."""
        begun = time.monotonic()
        try:
            function()
        except CallbackStopped:
            raise
        except BaseException as error:  # noqa: BLE001 - whatever the learner's code raises
            self._failures.callback_crashed(error, Turn(None, None, begun))

    def why_no_answer(self, service: str) -> str:
        """What is known about a server that does not answer."""
        return no_answer(self.nodes, self._running(), service, self._locate)

    def why_no_result(self, action: str) -> str:
        """What is known about an action server that does not answer."""
        return no_result(self.nodes, self._running(), action, self._locate, self.executions)

    def not_in_callback(self, what: str) -> None:
        """Raise DeadlockError if the caller is a callback on the lab's thread."""
        if self.in_callback():
            raise DeadlockError(
                f"{what} inside a callback would wait for the thread it runs on. Use the node's own client and "
                f"{'send_goal_async' if 'goal' in what else 'call_async'}() there."
            )

    def _running(self) -> Running:
        executor = self.executor_thread.executor
        return Running(executor.turn, self.executor_thread.thread_id, executor.unfinished())

    def before_blaming(self) -> None:
        """A server has gone: let a script that is about to end say why first."""
        self.on_server_gone()

    def flush_output(self) -> None:
        """Show what callbacks have printed, unless this is a callback."""
        self.output.drain()

    # What the overrides ask

    def in_callback(self) -> bool:
        """Whether the caller is inside a callback of the lab."""
        return self.executor_thread.is_current_thread()

    def turn(self) -> Turn | None:
        """The callback that is running on this thread, or the lab's."""
        execution = self.executions.current()
        return self.executor_thread.executor.turn if execution is None else turn_of(execution)

    def in_execution(self) -> bool:
        """Whether the caller is inside an execute callback on a thread of its own."""
        return self.executions.current() is not None

    def is_live(self, node: Node) -> bool:
        """Whether a node is one that the lab spins."""
        return node in self.nodes

    def is_own_executor(self, executor: Executor) -> bool:
        """Whether an executor is the lab's."""
        return executor is self.executor_thread.executor

    def note(self, text: str) -> None:
        """Tell the learner something in the notebook; a program is left alone."""
        if self._notebook.present:
            self.output.put(text + "\n")
            self.flush_output()

    def note_once(self, text: str) -> None:
        """Tell it the first time only."""
        if text not in self._noted:
            self._noted.add(text)
            self.note(text)

    def run_others(self, done: Callable[[], bool], timeout: float | None) -> None:
        """Inside a callback: run other callbacks until `done`, or for so many seconds."""
        self.executor_thread.executor.run_others(done, timeout)

    def end_strays(self, kept: Iterable[object]) -> list[str]:
        """Destroy the nodes that neither the lab nor an executor of the learner's runs; returns their names."""
        run = [node for live in self.nodes for node in (live.node, *live.helpers)]
        run += [node for executor in list(self.spinning) for node in executor.get_nodes()]
        ids = set(map(id, (*run, *self.guests, *kept)))
        return nodes.end_strays(lambda node: id(node) not in ids)

    def stop_soon(self, node: Node) -> None:
        """Stop a node when its callback has ended."""
        execution = self.executions.current()
        if execution is None:
            self.nodes.stop_soon(node)
        else:
            execution.afterwards.append(lambda: self.nodes.stop_soon(node))

    def wait_for_turn(self, timeout: float) -> None:
        """Return when a callback has run, or after `timeout` seconds."""
        turned = self.executor_thread.executor.turned
        turned.clear()
        turned.wait(timeout)

    # What telling of failures asks

    @property
    def hidden_node(self) -> Node | None:
        """The lab's own node, if it has been needed."""
        return self.clients.known_node

    def all_clients(self) -> list[Message]:
        """Every service client in the lab."""
        nodes = [one for live in self.nodes for one in (live.node, *live.helpers)]
        if self.clients.known_node is not None:
            nodes.append(self.clients.known_node)
        nodes += list(self.guests)
        return [client for node in nodes for client in list(node.clients)]

    def _end_goals(self, nodes: list[Node], patience: float = _JOIN) -> None:
        """Nodes are about to be destroyed: abort their goals, tell the clients, and end the threads."""
        if not any(isinstance(one, ActionServer) for node in nodes for one in getattr(node, "waitables", ())):
            return
        can_abort = self._found.has(compat.GOAL_ENDS)
        deadline = time.monotonic() + patience
        threads = self.executions.stop(nodes)
        if can_abort and self.executor_thread.is_current_thread():
            abort_goals(nodes)
            return
        if can_abort and self.executor_thread.run_between_callbacks(lambda: abort_goals(nodes), _FREE):
            self.executor_thread.run_between_callbacks(lambda: None, _FREE)  # results are sent as tasks of their own
            self.clients.wait_for_results({action for node in nodes for action in actions_of(node)}, _TOLD)
        for thread in threads:
            thread.join(max(0.0, deadline - time.monotonic()))

    def _forget(self, nodes: list[Node]) -> None:
        """Nodes are about to be destroyed."""
        self._failures.forget()
        self.executor_thread.executor.forget(nodes)
        channels: set[str] = set()
        for node in nodes:
            with contextlib.suppress(Exception):  # one that is destroyed already has none
                channels |= {service.service_name for service in node.services}
                channels |= {subscription.topic_name for subscription in node.subscriptions}
                channels |= actions_of(node)
        self.clients.forget(channels)


class Running(NamedTuple):
    """What runs on a thread of the lab."""

    turn: Turn | None
    thread_id: int
    unfinished: Sequence[Any] = ()


def no_answer(nodes: Iterable[LiveNode], running: Running, service: str, locate: Locate) -> str:
    """What is known about a service's server that does not answer."""
    if running.turn is not None and running.turn.entity is not None:
        return f"{_still_in(running, locate)}; while a callback runs, no other does."
    for live in nodes:
        serving = [one for one in live.node.services if one.service_name == service]
        if any(one is unfinished for one in serving for unfinished in running.unfinished):
            return f"A callback of {live.node.get_name()} for this service has not finished: it awaits something."
        if serving:
            return (
                f"{live.node.get_name()} serves it and none of its callbacks is at work: the request or its response "
                "was lost. Of what waits for a service, or for its client, the newest 10 are kept."
            )
    return (
        "Its server runs outside this notebook; its callback may still be running, or have raised an exception, "
        "or have returned nothing. Look at the server's own output."
    )


def no_result(nodes: Iterable[LiveNode], running: Running, action: str, locate: Locate, executions: Executions) -> str:
    """What is known about an action server that does not answer."""
    if running.turn is not None and running.turn.entity is not None:
        return f"{_still_in(running, locate)}; while a callback runs, no other does."
    for live in nodes:
        if action in actions_of(live.node):
            execution = executions.of(live.node)
            if execution is not None and execution.thread is not None:
                return f"{_still_in(Running(turn_of(execution), execution.thread.ident or 0), locate)}."
            if execution is None:  # a server may have no execute callback, or begin with the goal later
                return f"{live.node.get_name()} has not ended the goal, and no execute callback is running."
            return f"{live.node.get_name()} has not finished the goal: its execute callback awaits something."
    return "Its server runs outside this notebook and may still be busy with the goal. Look at the server's own output."


def _still_in(running: Running, locate: Locate) -> str:
    turn: Any = running.turn
    callback = turn.callback if turn.entity is None else getattr(turn.entity, "callback", None)
    name = getattr(callback, "__name__", "a callback")
    frame = sys._current_frames().get(running.thread_id)  # noqa: SLF001 - the documented way to look
    at = where_is(frame, locate)
    where = f" ({at[0]}: {at[1]})" if at else ""
    owner = turn.node.get_name() if turn.node is not None else "a node"
    return f"{owner} has been in {name}{where} for {time.monotonic() - turn.since:.0f} s"
