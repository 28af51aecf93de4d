"""The running half of a lab: made when ROS is first needed, ended once.

It puts the parts together: the executor's thread and its nodes, what is recorded, the client side of calls, and what to
say when a callback fails or no answer comes.
"""

from __future__ import annotations

import contextlib
import sys
import time
from typing import TYPE_CHECKING

import rclpy.utilities

from course_kit.lab.clients import Clients
from course_kit.lab.errors import CallbackStopped
from course_kit.lab.overrides.patches import Patches, quieten_finalizers
from course_kit.lab.recording.action_hooks import ActionHooks, hook_execution
from course_kit.lab.recording.hooks import MessageHooks
from course_kit.lab.runtime import execution, nodes
from course_kit.lab.runtime.describe import actions_of
from course_kit.lab.runtime.executor import ExecutorThread, LabExecutor
from course_kit.lab.runtime.failures import CallbackRun, Failures, where_is
from course_kit.lab.runtime.nodes import Nodes
from course_kit.ros import compat

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rclpy.executors import Executor
    from rclpy.node import Node

    from course_kit.lab.notebook.cells import Notebook
    from course_kit.lab.notebook.output import Output
    from course_kit.lab.recording.events import EventStream
    from course_kit.ros.compat import Compatibility
    from course_kit.ros.graph import Role

_JOIN = 0.5  # seconds an execute callback is given to end when its node is stopped; later it ends unseen
_LAST_JOIN = 2.0  # the same at the end of the lab


class Engine:
    """Everything of a lab that needs rclpy."""

    def __init__(self, events: EventStream, output: Output, notebook: Notebook, found: Compatibility) -> None:
        self.output, self.found, self.locate = output, found, notebook.locate
        self.before_call: Callable[[Role, str], None] = lambda *_: None
        self.guests: set[Node] = set()
        self.spinning: set[Executor] = set()  # the learner's own executors that run at this moment
        self.patches = Patches()
        self.hooks = MessageHooks(events)
        self._noted: set[str] = set()
        self._notebook = notebook
        self.failures = Failures(output, notebook.locate, self.hooks)
        self.executor_thread = ExecutorThread(notebook.ros_arguments(found), self.failures, found)
        self.executor = self.executor_thread.executor
        self.in_callback = self.executor_thread.is_current_thread
        self.not_in_callback = self.executor_thread.refuse_to_wait
        self.executions = execution.Executions(self.executor, output)
        self.nodes = Nodes(self.executor_thread, self._end_goals, self._forget)
        self.clients = Clients(self.executor_thread, self.hooks)
        self._patch_rclpy()

    def _patch_rclpy(self) -> None:
        patches, crashed = self.patches, self.failures.callback_crashed
        quieten_finalizers(patches)
        if self.found.has(compat.GOAL_RECORDING):
            ActionHooks(self.hooks, patches)  # before the sending of goals is held back
        if self.found.has(compat.EXECUTIONS):
            execution.execute_apart(patches, self.executions, crashed)
            hook_execution(patches, self.hooks)  # after it, so that it sees the thread of the callback itself
        if self.found.has(compat.WAITING_FOR_GOALS):
            execution.keep_replies(patches)
        self.nodes.watch(patches)
        if self.found.has(compat.RECORDING):
            self.hooks.on_failure = lambda *failed: self.failures.request_failed(self.executor.callback_run, *failed)
            self.hooks.hook_sending(patches)
            self.hooks.hook_taking(patches, LabExecutor)
        if self.found.has(compat.DEFAULT_CONTEXT):
            # Nodes that pass no context, and rclpy.ok(), use the default one.
            patches.set(rclpy.utilities, "g_default_context", self.executor_thread.context)
            patches.set(rclpy, "__executor", None)  # one from before has a context that may have ended

    def close(self) -> bool:
        """End everything; False if a callback could not be ended."""
        self._end_goals([live.node for live in self.nodes.live], _LAST_JOIN)
        try:
            return self.executor_thread.close(self._destroy_nodes)
        finally:
            self.patches.undo()

    def _destroy_nodes(self) -> None:
        self.nodes.destroy_all()
        self.clients.destroy()

    @property
    def node(self) -> Node:
        """The lab's own, hidden node."""
        return self.clients.node

    @property
    def own_names(self) -> frozenset[str]:
        return frozenset({self.node.get_fully_qualified_name()})

    def in_execution(self) -> bool:
        return self.executions.find_by_thread() is not None

    def callback_run(self) -> CallbackRun | None:
        """The callback that is running on this thread, or the lab's."""
        running = self.executions.find_by_thread()
        return self.executor.callback_run if running is None else execution.callback_of(running)

    def call_back(self, function: Callable[[], object]) -> None:
        """Call a learner's function on the lab's thread; report what it raises."""
        begun = time.monotonic()
        try:
            function()
        except CallbackStopped:
            raise
        except BaseException as error:  # noqa: BLE001 - whatever the learner's code raises
            self.failures.callback_crashed(error, CallbackRun(None, None, begun))

    def note(self, text: str) -> None:
        """Tell the learner something in the notebook; a program is left alone."""
        if self._notebook.present:
            self.output.put(text + "\n")
            self.output.drain()

    def note_once(self, text: str) -> None:
        if text not in self._noted:
            self._noted.add(text)
            self.note(text)

    def end_strays(self, kept: Iterable[object]) -> list[str]:
        """Destroy the nodes that neither the lab nor an executor of the learner's runs; returns their names."""
        run = [node for live in self.nodes.live for node in live.made]
        run += [node for executor in list(self.spinning) for node in executor.get_nodes()]
        ids = set(map(id, (*run, *self.guests, *kept)))
        return nodes.end_strays(lambda node: id(node) not in ids)

    def stop_soon(self, node: Node) -> None:
        running = self.executions.find_by_thread()
        if running is None:
            self.nodes.stop_soon(node)
        else:
            running.afterwards.append(lambda: self.nodes.stop_soon(node))

    def why_no_answer(self, service: str) -> str:
        if busy := self._busy():
            return busy
        for live in self.nodes.live:
            serving = [server for server in live.node.services if server.service_name == service]
            if any(server is unfinished for server in serving for unfinished in self.executor.unfinished_entities()):
                return f"A callback of {live.node.get_name()} for this service has not finished: it awaits something."
            if serving:
                return (
                    f"{live.node.get_name()} serves it and none of its callbacks is at work: the request or its "
                    "response was lost. Of what waits for a service, or for its client, the newest 10 are kept."
                )
        return (
            "Its server runs outside this notebook; its callback may still be running, or have raised an exception, "
            "or have returned nothing. Look at the server's own output."
        )

    def why_no_result(self, action: str) -> str:
        if busy := self._busy():
            return busy
        for live in self.nodes.live:
            if action in actions_of(live.node):
                running = self.executions.find_by_node(live.node)
                if running is not None and running.thread is not None:
                    return f"{self._still_in(execution.callback_of(running), running.thread.ident or 0)}."
                if running is None:  # a server may have no execute callback, or begin with the goal later
                    return f"{live.node.get_name()} has not ended the goal, and no execute callback is running."
                return f"{live.node.get_name()} has not finished the goal: its execute callback awaits something."
        return (
            "Its server runs outside this notebook and may still be busy with the goal. "
            "Look at the server's own output."
        )

    def _busy(self) -> str:
        turn = self.executor.callback_run
        if turn is None or turn.entity is None:
            return ""
        return f"{self._still_in(turn, self.executor_thread.thread_id)}; while a callback runs, no other does."

    def _still_in(self, turn: CallbackRun, thread_id: int) -> str:
        callback = turn.callback if turn.entity is None else getattr(turn.entity, "callback", None)
        name = getattr(callback, "__name__", "a callback")
        at = where_is(sys._current_frames().get(thread_id), self.locate)  # noqa: SLF001 - the documented way to look
        where = f" ({at[0]}: {at[1]})" if at else ""
        owner = turn.node.get_name() if turn.node is not None else "a node"
        seconds = time.monotonic() - turn.since
        return f"{owner} has been in {name}{where}{f' for {seconds:.0f} s' if seconds >= 1.0 else ''}"

    def _end_goals(self, ending: list[Node], patience: float = _JOIN) -> None:
        """Nodes are about to be destroyed: end the threads of their goals."""
        deadline = time.monotonic() + patience
        threads = self.executions.stop(ending)
        for thread in () if self.in_callback() else threads:
            thread.join(max(0.0, deadline - time.monotonic()))

    def _forget(self, ending: list[Node]) -> None:
        self.failures.forget()
        self.executor.forget(ending)
        channels: set[str] = set()
        for node in ending:
            with contextlib.suppress(Exception):  # one that is destroyed already has none
                channels |= {service.service_name for service in node.services}
                channels |= {subscription.topic_name for subscription in node.subscriptions}
                channels |= actions_of(node)
        self.clients.forget(channels)
