"""A ROS context with one thread that runs callbacks, and its end in the one order that is clean.

Ending a process while a thread is inside rcl_wait aborts it ("terminate called"). So the thread is told to stop,
woken and joined before anything is destroyed; `threading._register_atexit` has that done at interpreter exit
early enough, before Python begins to take its threads away.
"""

from __future__ import annotations

import ctypes
import threading
from typing import TYPE_CHECKING, TypeVar

import rclpy
from rclpy.context import Context
from rclpy.signals import SignalHandlerOptions

from course_kit.lab.errors import CallbackStopped, NoAnswerError
from course_kit.lab.runtime.executor import LabExecutor, RecordingExecutor
from course_kit.ros import compat

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.recording.hooks import MessageHooks
    from course_kit.lab.runtime.failures import Failures
    from course_kit.ros.compat import Compatibility

# rclpy's ~/get_type_description, which no lesson asks for, triples the time to make a node and leaves 100 kB behind
# for each one destroyed, until the last node of the process is gone.
_ARGUMENTS = ("--ros-args", "-p", "start_type_description_service:=false")
ResultT = TypeVar("ResultT")
_JOIN = 2.0  # seconds a callback is given to end


class ExecutorThread:
    """Owns the context, the executor and the thread."""

    def __init__(self, ros_arguments: list[str], hooks: MessageHooks, failures: Failures, found: Compatibility) -> None:
        # Where the default context cannot be replaced by ours, ours is that one.
        self.context = Context() if found.has(compat.DEFAULT_CONTEXT) else rclpy.get_default_context()
        rclpy.init(
            args=[*ros_arguments, *_ARGUMENTS], context=self.context, signal_handler_options=SignalHandlerOptions.NO
        )
        records = found.has(compat.RECORDING)
        self.executor: LabExecutor = (
            RecordingExecutor(self.context, hooks, failures) if records else LabExecutor(self.context, failures)
        )
        self._thread = threading.Thread(target=self.executor.run, name="ros-lab", daemon=True)
        self._thread.start()

    @property
    def thread_id(self) -> int:
        """The identifier of the thread that runs callbacks."""
        return self._thread.ident or 0

    def is_current_thread(self) -> bool:
        """Whether the caller is inside a callback."""
        return threading.current_thread() is self._thread

    def run_between_callbacks(self, function: Callable[[], object], deadline: float) -> bool:
        """Run `function` on the thread while no callback is running."""
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
        outcome: list[ResultT] = []
        raised: list[BaseException] = []
        late = False

        def run() -> None:
            if late:
                return
            try:
                outcome.append(function())
            except BaseException as error:  # noqa: BLE001 - passed on
                raised.append(error)

        if not self.run_between_callbacks(run, deadline):
            late = True
            raise NoAnswerError(
                f"A callback has blocked the lab's thread for more than {deadline:g} s, so this was not done."
            )
        if raised:
            raise raised[0]
        return outcome[0]

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
