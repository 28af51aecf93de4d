"""Execute callbacks of action servers: each on its own thread, as on a MultiThreadedExecutor.

On the lab's one thread they would keep feedback, cancel requests and every other node waiting. All other callbacks
stay one at a time; an execute callback that is a coroutine runs on the lab's thread.

A goal sent from a cell may be answered before rclpy's action client has noted that it waits for an answer (issue
1123 of rclpy), because another thread takes the answer. Here taking waits for the sending to be complete.
"""

from __future__ import annotations

import ctypes
import functools
import inspect
import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionClient, ActionServer
from rclpy.task import Future

from course_kit.lab.errors import CallbackStopped
from course_kit.lab.recording.hooks import WrongResultError
from course_kit.lab.runtime.failures import CallbackRun

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable

    from rclpy.action.server import ServerGoalHandle
    from rclpy.node import Node

    from course_kit.lab.notebook.output import Output
    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.runtime.executor import LabExecutor
    from course_kit.ros.messages import Message

    Execute = Callable[[ServerGoalHandle], Message]  # an execute callback; one with `async` returns an awaitable


class Execution:
    """One goal that is being executed."""

    def __init__(self, node: Node, callback: Execute, goal_handle: ServerGoalHandle, wake: Callable[[], None]) -> None:
        self.node = node
        self.begun = time.monotonic()
        self.stopped = False
        self.afterwards: list[Callable[[], None]] = []
        self.callback = callback
        self._goal_handle = goal_handle
        self._wake = wake
        self._changing = threading.Lock()
        self._called = False
        self._ended = False
        self._result: Any = None
        self._error: BaseException | None = None
        self._news = Future()  # done when there is a reason to go on
        self.thread: threading.Thread | None = None

    def begin(self, output: Output) -> None:
        """Call the callback on its own thread, whose output is shown as that of other callbacks."""

        def run() -> None:
            output.producers.add(threading.get_ident())
            try:
                while not self._ended:  # the exception that stops it may come at any moment, here as well
                    with suppress(CallbackStopped):
                        self._call_once()
            finally:
                output.producers.discard(threading.get_ident())
                self._go_on()

        self.thread = threading.Thread(target=run, name="ros-execute", daemon=True)
        self.thread.start()

    def _call_once(self) -> None:
        if not self._called:
            self._called = True
            try:
                self._result = self.callback(self._goal_handle)
            except CallbackStopped:
                pass
            except BaseException as error:  # noqa: BLE001 - also sys.exit(), which must not end the thread unseen
                self._error = error
        with self._changing:
            self._ended = True

    def stop(self) -> None:
        """Have it end soon; ignore what it returns or raises."""
        self.stopped = True
        self._go_on()
        thread = self.thread
        with self._changing:
            if thread is not None and thread is not threading.current_thread() and not self._ended:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(
                    ctypes.c_ulong(thread.ident or 0), ctypes.py_object(CallbackStopped)
                )

    def _go_on(self) -> None:
        if not self._news.done():
            self._news.set_result(None)
        self._wake()  # until rclpy 7.1.8 the executor does not notice that a future is done

    def __await__(self) -> Generator[Any, None, Any]:
        """Wait on the lab's thread, as a task of its executor; return or raise what the callback did."""
        if self.thread is None:
            yield from self._steps()
        elif not self._ended and not self.stopped:
            yield from self._news.__await__()
        if self.stopped:
            raise CallbackStopped
        if self._error is not None:
            raise self._error
        return self._result

    def _steps(self) -> Generator[Any, None, None]:
        steps = self.callback(self._goal_handle).__await__()
        try:
            while not self.stopped:
                try:
                    awaited = next(steps)
                except StopIteration as end:
                    self._result, self._ended = end.value, True
                    return
                yield from self._wait_for(awaited)
        finally:
            steps.close()

    def _wait_for(self, awaited: Any) -> Generator[Any, None, None]:
        """Wait for what a step awaits, or until it is stopped."""
        if not isinstance(awaited, Future):
            yield
            return
        self._news = news = Future()

        def go_on(_: object) -> None:
            if not news.done():
                self._go_on()

        awaited.add_done_callback(go_on)
        if not self.stopped:
            yield from news.__await__()


class Executions:
    """The goals that are being executed in one lab."""

    def __init__(self, executor: LabExecutor, output: Output) -> None:
        self.executor = executor
        self._output = output
        self._running: dict[Execution, None] = {}  # a set in the order of beginning

    async def run(self, server: ActionServer, callback: Execute, goal_handle: ServerGoalHandle) -> Message:
        node = server._node  # noqa: SLF001 - rclpy has no other way to it
        execution = Execution(node, callback, goal_handle, self.executor.wake)
        self._running[execution] = None
        try:
            if not inspect.iscoroutinefunction(callback):
                execution.begin(self._output)
            return await execution
        finally:
            del self._running[execution]
            for function in execution.afterwards:
                self.executor.create_task(function)

    def find_by_thread(self) -> Execution | None:
        thread = threading.current_thread()
        return next((run for run in list(self._running) if run.thread is thread), None)

    def find_by_node(self, node: Node) -> Execution | None:
        return next((run for run in list(self._running) if run.node is node), None)

    def stop(self, nodes: Iterable[Node]) -> list[threading.Thread]:
        ending = [run for run in list(self._running) if any(run.node is node for node in nodes)]
        for run in ending:
            run.stop()
        self.executor.wake()
        threads = [run.thread for run in ending if run.thread is not None]
        return [thread for thread in threads if thread is not threading.current_thread()]


def callback_of(execution: Execution) -> CallbackRun:
    """An execution as the callback that is running."""
    return CallbackRun(None, execution.node, execution.begun, execution.callback)


def keep_replies(patches: Patches) -> None:
    """Have a client note what it waits for before it takes any reply; `patches` takes it back."""
    sending = threading.RLock()

    def hold(original: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(original)
        def call_locked(*arguments: Any, **options: Any) -> Any:
            with sending:
                return original(*arguments, **options)

        return call_locked

    for method in ("send_goal_async", "_cancel_goal_async", "_get_result_async", "take_data"):
        patches.set(ActionClient, method, hold(getattr(ActionClient, method)))


def execute_apart(
    patches: Patches, executions: Executions, crashed: Callable[[BaseException, CallbackRun], None]
) -> None:
    """Have `executions` execute goals; `crashed` gets what they raise."""
    execute_goal = ActionServer._execute_goal  # noqa: SLF001 - all of a server's goals pass here, however they are begun

    async def execute_goal_apart(
        server: ActionServer, execute_callback: Execute, goal_handle: ServerGoalHandle
    ) -> None:
        node = server._node  # noqa: SLF001 - rclpy has no other way to it
        begun = time.monotonic()

        async def execute(handle: ServerGoalHandle) -> Message:
            try:
                return await _result(executions, server, execute_callback, handle)
            except CallbackStopped:
                raise
            except BaseException as error:  # noqa: BLE001 - whatever the learner's code raises
                crashed(error, CallbackRun(None, node, begun, execute_callback))
                if handle.is_active:
                    handle.abort()
                return server.action_type.Result()

        await execute_goal(server, execute, goal_handle)

    patches.set(ActionServer, "_execute_goal", execute_goal_apart)


async def _result(
    executions: Executions, server: ActionServer, execute_callback: Execute, handle: ServerGoalHandle
) -> Message:
    if server._node.executor is executions.executor:  # noqa: SLF001 - as above
        result = await executions.run(server, execute_callback, handle)
    elif inspect.iscoroutinefunction(execute_callback):
        result = await execute_callback(handle)
    else:
        result = execute_callback(handle)
    if not isinstance(result, server.action_type.Result):
        raise WrongResultError(result, server.action_type)
    return result
