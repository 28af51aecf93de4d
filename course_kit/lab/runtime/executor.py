"""The executor of the lab, rclpy's single-threaded one, which outlives the errors of callbacks; its thread and context.

Ending a process while a thread is inside rcl_wait aborts it ("terminate called"). So the thread is asked to stop,
woken and joined before anything is destroyed; `threading._register_atexit` has that done at interpreter exit
early enough, before Python begins to take its threads away.
"""

from __future__ import annotations

import ctypes
import threading
import time
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, TypeVar

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import (
    ConditionReachedException,
    Executor,
    ExternalShutdownException,
    ShutdownException,
    TimeoutException,
)
from rclpy.signals import SignalHandlerOptions

from course_kit.lab.errors import CallbackStopped, DeadlockError, NoAnswerError
from course_kit.lab.runtime.describe import is_alive
from course_kit.lab.runtime.failures import CallbackRun
from course_kit.ros import compat

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.task import Task

    from course_kit.lab.runtime.failures import Failures
    from course_kit.ros.compat import Compatibility

_DEEPEST = 8  # callbacks that wait inside each other; a MultiThreadedExecutor's threads are no more
_JOIN = 2.0  # seconds a callback is given to end
_BREATH = 0.1  # seconds between attempts while the middleware itself fails
# rclpy's ~/get_type_description, which no lesson asks for, triples the time to make a node and leaves 100 kB behind
# for each one destroyed, until the last node of the process is gone.
_ARGUMENTS = ("--ros-args", "-p", "start_type_description_service:=false")
ResultT = TypeVar("ResultT")


class LabExecutor(Executor):
    """Runs callbacks one after the other on the thread that calls `run`."""

    def __init__(self, context: Context, failures: Failures) -> None:
        super().__init__(context=context)
        self._running: CallbackRun | None = None
        self._begun: dict[Task, CallbackRun] = {}  # what has not ended, by its task, oldest first
        self._waiting: list[Task] = []  # what waits inside its callback while others run, outermost first
        self.turned = threading.Event()
        self._failures = failures
        self._stop = threading.Event()

    @property
    def callback_run(self) -> CallbackRun | None:
        if self._running is not None and self._running.entity is None:
            for task, turn in list(self._begun.items()):
                if turn.entity is not None and task.executing() and task not in self._waiting:
                    return turn
        return self._running

    def run(self) -> None:
        """Execute callbacks until `request_stop`, whatever they raise."""
        while not self._stop.is_set() and self.context.ok():
            self._spin_safely()

    def request_stop(self) -> None:
        self._stop.set()
        self.wake()

    def run_others(self, done: Callable[[], bool], timeout: float | None) -> None:
        """Inside a callback: run other callbacks, as their groups allow, until `done` or for so many seconds."""
        if len(self._waiting) >= _DEEPEST:
            raise DeadlockError(f"{_DEEPEST} callbacks wait inside each other: no thread is left for the answer.")
        turn, waiting = self._running, self._waiting
        deadline = None if timeout is None or timeout < 0 else time.monotonic() + timeout
        self._waiting = [task for task in self._begun if task.executing()]
        try:
            while not done() and not self._stop.is_set():
                left = _BREATH if deadline is None else min(_BREATH, max(0.0, deadline - time.monotonic()))
                self._spin_safely(left)
                self._running = turn
                if turn is not None and turn.node is not None and not is_alive(turn.node):
                    raise CallbackStopped
                if deadline is not None and time.monotonic() >= deadline:
                    return
            if self._stop.is_set():
                raise CallbackStopped
        finally:
            self._running, self._waiting = turn, waiting

    def forget(self, nodes: list[Node]) -> None:
        self._begun = {task: turn for task, turn in self._begun.items() if turn.node is None or turn.node not in nodes}

    def spin_once(self, timeout_sec: float | None = None) -> None:
        try:
            found: tuple[Any, Any, Any] = self.wait_for_ready_callbacks(timeout_sec, None, self._stop.is_set)
        except (TimeoutException, ConditionReachedException):
            return
        handler, entity, node = found
        self._run_handler(handler, CallbackRun(entity, node, time.monotonic()))

    def _spin_safely(self, timeout: float | None = None) -> None:
        try:
            self.spin_once(timeout)
        except (ShutdownException, ExternalShutdownException):
            self._stop.set()
        except (InvalidHandle, CallbackStopped):  # destroyed while it was waited on; or the callback had just ended
            pass
        except Exception as error:  # noqa: BLE001 - nothing may end this thread but `request_stop`
            self._failures.callback_crashed(error, CallbackRun(None, None, 0.0))
            self._stop.wait(_BREATH)

    def _run_handler(self, handler: Task, turn: CallbackRun) -> None:
        self._running = turn
        self._begun.setdefault(handler, turn)
        raised: BaseException | None = None
        try:
            handler()
        except BaseException as error:  # noqa: BLE001 - sys.exit() in a callback must not end the lab
            raised = error
        finally:
            self._running = None
            self.turned.set()
        if raised is not None:
            self._drop_broken(raised, turn)
        for task in [task for task in self._begun if task.done() or task.cancelled()]:
            ended = self._begun.pop(task)
            self._tell(task.exception() if task.done() else None, ended)

    def _drop_broken(self, error: BaseException, turn: CallbackRun) -> None:
        """What rclpy's tasks do not catch has broken the callback, and the task that went on with it."""
        broken = [task for task in self._begun if task.executing() and task not in self._waiting]
        if broken:
            turn = self._begun[broken[0]]
        for task in broken:
            del self._begun[task]
            task.cancel()
        self._tell(error, turn)

    def wait_for_turn(self, timeout: float) -> None:
        """Return when a callback has run, or after `timeout` seconds."""
        self.turned.clear()
        self.turned.wait(timeout)

    def unfinished_entities(self) -> list[Any]:
        """What the callbacks were called for that have begun and not ended, because they run or await something."""
        return [turn.entity for turn in list(self._begun.values())]

    def _tell(self, error: BaseException | None, turn: CallbackRun) -> None:
        if error is not None and not isinstance(error, (InvalidHandle, CallbackStopped)):
            self._failures.callback_crashed(error, turn)


class ExecutorThread:
    """Owns the context, the executor and the thread."""

    def __init__(self, ros_arguments: list[str], failures: Failures, found: Compatibility) -> None:
        # Where the default context cannot be replaced by ours, ours is that one.
        self.context = Context() if found.has(compat.DEFAULT_CONTEXT) else rclpy.get_default_context()
        rclpy.init(
            args=[*ros_arguments, *_ARGUMENTS], context=self.context, signal_handler_options=SignalHandlerOptions.NO
        )
        self.executor = LabExecutor(self.context, failures)
        self._thread = threading.Thread(target=self.executor.run, name="ros-lab", daemon=True)
        self._thread.start()

    @property
    def thread_id(self) -> int:
        return self._thread.ident or 0

    def is_current_thread(self) -> bool:
        return threading.current_thread() is self._thread

    def refuse_to_wait(self, what: str) -> None:
        if self.is_current_thread():
            raise DeadlockError(
                f"{what} inside a callback would wait for the thread it runs on. Use the node's own client and "
                f"{'send_goal_async' if 'goal' in what else 'call_async'}() there."
            )

    def run_between_callbacks(self, function: Callable[[], object], deadline: float) -> bool:
        if self.is_current_thread():
            function()
            return True
        if not self._thread.is_alive():  # the lab has ended, and so has what it owned
            return False
        done = threading.Event()

        def task() -> None:
            try:
                function()
            finally:
                done.set()

        self.executor.create_task(task)
        return done.wait(deadline)

    def ask(self, function: Callable[[], ResultT], deadline: float) -> ResultT:
        """Return what `function` returns on the thread, between two callbacks; what it raises is raised here."""
        outcome: Future[ResultT] = Future()

        def run() -> None:
            if outcome.set_running_or_notify_cancel():
                try:
                    outcome.set_result(function())
                except BaseException as error:  # noqa: BLE001 - passed on
                    outcome.set_exception(error)

        if not self.run_between_callbacks(run, deadline) and outcome.cancel():
            raise NoAnswerError(
                f"A callback has blocked the lab's thread for more than {deadline:g} s, so this was not done."
            )
        return outcome.result()

    def stop_callback(self) -> None:
        """Raise CallbackStopped inside the callback that is running; reaches Python code, not a C function."""
        if not self.is_current_thread() and self._thread.is_alive():
            ctypes.pythonapi.PyThreadState_SetAsyncExc(
                ctypes.c_ulong(self.thread_id), ctypes.py_object(CallbackStopped)
            )

    def close(self, destroy_nodes: Callable[[], None]) -> bool:
        """End the thread, then the nodes, then the context."""
        self.executor.request_stop()
        self._thread.join(_JOIN)
        if self._thread.is_alive():
            self.stop_callback()
            self._thread.join(_JOIN)
        if self._thread.is_alive():
            return False
        destroy_nodes()
        self.executor.shutdown()
        self.context.try_shutdown()
        return True
