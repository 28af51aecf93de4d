"""Stand-ins for what later versions of rclpy do; those cannot be had where the course installs rclpy itself.

Each function replaces a part of the rclpy that is installed, through pytest's monkeypatch.
"""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionServer
from rclpy.action.server import ServerGoalHandle
from rclpy.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.task import Future, Task

if TYPE_CHECKING:
    from collections.abc import Generator

    import pytest


def await_as_in_7_1_9(patch: pytest.MonkeyPatch) -> None:  # noqa: C901 - one behaviour of four functions
    """A coroutine that awaits a future yields it, and is resumed once, by a task of the future's own."""
    waiting: set[Any] = set()
    run_function = Task.__call__

    def await_once(future: Any) -> Generator[Any, None, Any]:
        if not future.done() and not future.cancelled():
            yield future
        if not future.done() and not future.cancelled():
            raise RuntimeError("Future awaited a second time before it was done")
        return future.result()

    def resume(task: Any) -> None:
        waiting.discard(task)
        task()

    def step(task: Any) -> None:
        if not inspect.iscoroutine(task._handler):
            run_function(task)
            return
        if task.done() or task.cancelled() or task in waiting:
            return
        task._executing = True  # it stays so after what is no Exception
        try:
            awaited = task._handler.send(None)
        except StopIteration as end:
            task.set_result(end.value)
        except Exception as error:  # noqa: BLE001 - as rclpy does
            task.set_exception(error)
        else:
            if isinstance(awaited, Future):
                waiting.add(task)
                if awaited._executor() is None:
                    awaited._set_executor(task._executor())
                awaited.add_done_callback(lambda _: resume(task))
        task._executing = False

    patch.setattr(Future, "__await__", await_once)
    patch.setattr(Task, "__call__", step)


def refuse_a_second_spin_as_in_7_1_9(patch: pytest.MonkeyPatch) -> None:
    """An executor that spins does not spin again, not even once."""
    spinning: set[int] = set()

    def guard(owner: Any, method: str) -> None:
        original = getattr(owner, method)

        def guarded(executor: Any, *arguments: Any, **options: Any) -> Any:
            if id(executor) in spinning:
                raise RuntimeError("Executor is already spinning")
            spinning.add(id(executor))
            try:
                return original(executor, *arguments, **options)
            finally:
                spinning.discard(id(executor))

        patch.setattr(owner, method, guarded)

    for owner in (SingleThreadedExecutor, MultiThreadedExecutor):
        guard(owner, "spin_once")
        guard(owner, "spin_once_until_future_complete")


def shut_the_pool_down_as_in_7_1_12(patch: pytest.MonkeyPatch) -> None:
    """A MultiThreadedExecutor ends its threads when it is shut down, and takes no callback any more."""

    def shutdown(executor: Any, timeout_sec: float | None = None, *, wait_for_threads: bool = True) -> bool:
        done = Executor.shutdown(executor, timeout_sec)
        executor._executor.shutdown(wait=wait_for_threads)
        return bool(done)

    patch.setattr(MultiThreadedExecutor, "shutdown", shutdown)


def do_without_execute_callback_as_in_7_1_8(patch: pytest.MonkeyPatch) -> None:
    """An action server may have no execute callback; whoever has the goal's handle ends it, with its result."""
    initialise, succeed = ActionServer.__init__, ServerGoalHandle.succeed

    def initialise_without(server: Any, *arguments: Any, execute_callback: Any = None, **options: Any) -> None:
        initialise(server, *arguments, execute_callback or print, **options)
        server._execute_callback = execute_callback

    def succeed_with(handle: Any, response: Any = None) -> None:
        succeed(handle)
        if response is not None:
            server = handle._action_server
            message = server.action_type.Impl.GetResultService.Response(status=handle.status, result=response)
            server._result_futures[bytes(handle.goal_id.uuid)].set_result(message)

    patch.setattr(ActionServer, "__init__", initialise_without)
    patch.setattr(ServerGoalHandle, "succeed", succeed_with)
