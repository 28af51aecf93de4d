"""What rclpy's own functions do while the lab runs: what a learner expects of them in a cell.

Inside a callback those that could only wait for the callback's own thread raise DeadlockError instead of hanging.
"""

from __future__ import annotations

import asyncio
import functools
import inspect
import re
import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.client import Client
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.task import Future

from course_kit import environment
from course_kit.lab.calls import make_waker
from course_kit.lab.clients import WantedServer, not_found
from course_kit.lab.errors import CallbackError, DeadlockError, LabError
from course_kit.lab.runtime.failures import is_own, own_line
from course_kit.ros import compat
from course_kit.ros.graph import RUNS, SERVES
from course_kit.ros.messages import type_name, with_article
from course_kit.ros.names import full_action_name

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import FrameType

    from rclpy.context import Context

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.runtime.engine import Engine
    from course_kit.lab.runtime.failures import Locate
    from course_kit.ros.messages import Message

_FOR_EVER = "inside a callback would wait for ever: only the thread that runs this callback can take the answer."
_NO_SERVER_S = 5.0  # after which a cell's own request is given up where nobody offers the service
_SLICE = 0.1  # seconds a wait inside the middleware lasts before Python may see an interrupt


def replace_functions(lab: Engine) -> None:
    """Replace rclpy's functions; the lab's patches take it back."""
    patches = lab.patches
    _guard_context(patches, lab)
    _guard_spinning(patches, lab)
    _guard_spinning_for_a_while(patches, lab)
    _guard_executors(patches, lab)
    _guard_calls(patches, lab)
    _guard_awaits(patches, lab)
    _guard_callbacks(patches, lab.locate)


def _check_await(lab: Engine, future: Future) -> None:
    """Raise DeadlockError for an await in a callback whose answer could only be taken after that callback."""
    if not lab.in_callback() or future.done():
        return
    if (client := _held_back(lab, future)) is not None:
        name = getattr(client, "service_name", "the action")
        raise DeadlockError(
            f"This callback and its client for {name} share one callback group, so the answer "
            "would have to wait for the callback, and the callback waits for the answer. Give the client its own: "
            "create_client(..., callback_group=MutuallyExclusiveCallbackGroup())."
        )


def _held_back(lab: Engine, future: Future) -> Client | ActionClient | None:
    """Whose answer a future is, if the running callback's own group keeps it from being taken."""
    turn = lab.callback_run()
    if turn is None or turn.node is None:
        return None
    clients: list[Any] = [*turn.node.clients, *(end for end in turn.node.waitables if isinstance(end, ActionClient))]
    return next((client for client in clients if _excludes(lab, client) and _waits_for(client, future)), None)


def _excludes(lab: Engine, client: Client | ActionClient) -> bool:
    """Whether no answer for a client can be taken while the running callback lasts, in any executor."""
    turn = lab.callback_run()
    group = turn.entity.callback_group if turn is not None and turn.entity is not None else None
    return isinstance(group, MutuallyExclusiveCallbackGroup) and client.callback_group is group


def _waits_for(client: Client | ActionClient, future: Future) -> bool:
    pending = [named for name, named in vars(client).items() if name.startswith("_pending_")]
    return any(other is future for futures in pending if isinstance(futures, dict) for other in futures.values())


def _guard_context(patches: Patches, lab: Engine) -> None:
    init, shutdown, try_shutdown = rclpy.init, rclpy.shutdown, rclpy.try_shutdown

    @functools.wraps(init)
    def init_in_lab(
        *,
        args: list[str] | None = None,
        context: Context | None = None,
        domain_id: int | None = None,
        signal_handler_options: Any = None,
    ) -> None:
        if context is not None:
            init(args=args, context=context, domain_id=domain_id, signal_handler_options=signal_handler_options)
            return
        ignored = "--ros-args" in (args or ()) or domain_id not in {None, lab.executor_thread.context.get_domain_id()}
        rest = "its arguments are ignored." if ignored else "nothing to do."
        lab.note(f"rclpy.init(): ROS is already running in this notebook; {rest}")

    def end(original: Any, name: str, context: Context | None, options: dict[str, Any]) -> None:
        turn = lab.callback_run()
        if context is not None:
            original(context=context, **options)
        elif (lab.in_callback() or lab.in_execution()) and turn is not None and turn.node is not None:
            lab.note(f"{turn.node.get_name()} called {name}: in the lab that stops this node only.")
            lab.stop_soon(turn.node)
        else:
            lab.note(f"{name}: ROS stays up in this notebook. lab.stop() stops the lab's nodes.")

    patches.set(rclpy, "init", init_in_lab)
    patches.set(
        rclpy, "shutdown", lambda *, context=None, **options: end(shutdown, "rclpy.shutdown()", context, options)
    )
    patches.set(rclpy, "try_shutdown", lambda *, context=None: end(try_shutdown, "rclpy.try_shutdown()", context, {}))


def _guard_spinning(patches: Patches, lab: Engine) -> None:
    def spin(node: Node, executor: Executor | None = None) -> None:
        _refuse_to_stay(lab, "rclpy.spin()")
        if node in lab.nodes:
            lab.note(f"rclpy.spin(): the lab spins {node.get_name()} in the background already; nothing to do.")
            return
        if isinstance(node, type):
            raise LabError(f"rclpy.spin() takes a node, not a class. In a notebook: lab.start({node.__name__}).")
        lab.note(
            f"rclpy.spin(): this cell runs {node.get_name()} until you press Stop, and no other cell can run. "
            f"lab.start({type(node).__name__}) runs it in the background instead."
        )
        executor = executor or rclpy.get_global_executor()
        executor.add_node(node)
        try:
            Executor.spin(executor)  # as below, also where it has another one, such as that of C++
        finally:
            executor.remove_node(node)  # as rclpy.spin() does, also where the node was there before
            if executor.context.ok() and not executor.get_nodes():
                executor.spin_once(timeout_sec=0)  # only here does the one of C++ let go of the node

    patches.set(rclpy, "spin", spin)


def _guard_spinning_for_a_while(patches: Patches, lab: Engine) -> None:
    def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
        at_most = _SLICE if timeout_sec is None or timeout_sec < 0 else timeout_sec
        if node not in lab.nodes:
            _spin_for(node, executor, lambda executor: executor.spin_once(timeout_sec=at_most))
            return
        _tell_of_spinning(lab, "rclpy.spin_once()", node)
        if lab.in_callback():
            lab.executor.run_others(lambda: False, min(at_most, _SLICE))
        else:
            lab.executor.wait_for_turn(min(at_most, _SLICE))
            lab.output.drain()

    def spin_until_future_complete(
        node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
    ) -> None:
        what = "rclpy.spin_until_future_complete()"
        if node not in lab.nodes:
            _spin_for(node, executor, lambda executor: _spin_until(lab, executor, future, timeout_sec))
            return
        endless = timeout_sec is None or timeout_sec < 0
        if endless and lab.in_callback() and not future.done() and _held_back(lab, future) is not None:
            raise DeadlockError(f"{what} {_FOR_EVER} Return, and let add_done_callback() run what comes next.")
        _tell_of_spinning(lab, what, node)
        _has_come(lab, future, timeout_sec)

    patches.set(rclpy, "spin_once", spin_once)
    patches.set(rclpy, "spin_until_future_complete", spin_until_future_complete)


def _guard_executors(patches: Patches, lab: Engine) -> None:
    def spin(executor: Executor) -> None:
        _refuse_to_stay(lab, f"{type(executor).__name__}.spin()")
        lab.spinning.add(executor)
        try:
            while executor.context.ok() and not getattr(executor, "_is_shutdown", False):
                executor.spin_once(timeout_sec=_SLICE)  # in between Python sees that Stop was pressed
                lab.output.drain()
        finally:
            lab.spinning.discard(executor)

    patches.set(Executor, "spin", spin)

    add_node = Executor.add_node

    def add_node_kept(executor: Executor, node: Node) -> bool:
        if node in lab.nodes and executor is not lab.executor:
            lab.note(
                f"{type(executor).__name__}.add_node(): the lab spins {node.get_name()} already and keeps it. "
                f"lab.stop({node.get_name()!r}) frees the name for your own node."
            )
            return False
        return bool(add_node(executor, node))

    patches.set(Executor, "add_node", add_node_kept)


def _guard_calls(patches: Patches, lab: Engine) -> None:
    call = Client.call

    def call_guarded(client: Client, request: Message, timeout_sec: float | None = None) -> Message:
        if not lab.in_callback() and not lab.in_execution():
            return call(client, request, timeout_sec)
        _require_an_answer(lab, client, f"call() of {client.service_name}", "call_async()")
        future = client.call_async(request)
        if not _has_come(lab, future, timeout_sec):
            client.remove_pending_request(future)
        return future.result()

    patches.set(Client, "call", call_guarded)


def _require_an_answer(lab: Engine, client: Client | ActionClient, what: str, instead: str) -> None:
    """In a callback: raise for a call whose answer nobody could take, and say what any other needs in a program."""
    if not lab.in_callback():
        return
    if _excludes(lab, client):
        raise DeadlockError(f"{what} {_FOR_EVER} Use {instead} and add_done_callback() instead.")
    lab.note_once(
        f"{what} inside a callback: the lab runs other callbacks meanwhile. A separate program needs a "
        "MultiThreadedExecutor for that; with rclpy.spin() it would wait for ever."
    )


def _refuse_to_stay(lab: Engine, what: str) -> None:
    """Raise in a callback for a function that does not return."""
    if lab.in_callback():
        raise DeadlockError(f"{what} {_FOR_EVER} Return, and let add_done_callback() run what comes next.")
    if lab.in_execution():
        raise DeadlockError(f"{what} inside an execute callback never returns, so the goal would never end.")


def _tell_of_spinning(lab: Engine, what: str, node: Node) -> None:
    """Say in a callback what differs from a separate program."""
    if lab.in_callback() or lab.in_execution():
        lab.note_once(
            f"{what} inside a callback of {node.get_name()}: the lab runs other callbacks meanwhile, as rclpy.spin() "
            "does in a separate program. An executor of the program's own, such as a MultiThreadedExecutor, would lose "
            "the node."
        )


def _has_come(lab: Engine, future: Future, timeout: float | None) -> bool:
    """Wait for a future; False if it is not done within `timeout` seconds."""
    if lab.in_callback():
        lab.executor.run_others(future.done, timeout)
        return bool(future.done())
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    deadline = None if timeout is None or timeout < 0 else time.monotonic() + timeout
    while deadline is None or time.monotonic() < deadline:
        if done.wait(_SLICE if deadline is None else max(0.0, min(_SLICE, deadline - time.monotonic()))):
            break
        lab.output.drain()
    lab.output.drain()
    return done.is_set()


def _spin_for(node: Node, executor: Executor | None, work: Callable[[Executor], None]) -> None:
    """Have an executor of rclpy's own do `work` with a node that the lab does not spin."""
    executor = executor or rclpy.get_global_executor()
    added = executor.add_node(node)
    try:
        work(executor)
    finally:
        if added:
            executor.remove_node(node)


def _spin_until(lab: Engine, executor: Executor, future: Future, timeout: float | None) -> None:
    """Spin as rclpy would, letting Python see an interrupt now and then."""
    deadline = None if timeout is None or timeout < 0 else time.monotonic() + timeout
    future.add_done_callback(lambda _: executor.wake())
    while executor.context.ok() and not future.done() and not future.cancelled():
        if lab.in_callback():  # what is waited for may come from a node of the lab
            lab.executor.run_others(future.done, 0.0)
        left = _SLICE if deadline is None else min(_SLICE, deadline - time.monotonic())
        if left <= 0:
            return
        executor.spin_once(timeout_sec=left)


async def _await_in_cell(lab: Engine, future: Future) -> Any:
    """Wait for an rclpy future in the running loop; who stops waiting cancels it."""
    news, wake = make_waker()
    future.add_done_callback(wake)
    try:
        while not future.done():
            with suppress(asyncio.TimeoutError):
                await asyncio.wait_for(news.wait(), _NO_SERVER_S)
                break
            _require_server(lab, future)
    except asyncio.CancelledError:
        future.cancel()
        raise
    if future.cancelled():
        raise asyncio.CancelledError
    return future.result()


def _require_server(lab: Engine, future: Future) -> None:
    """Raise for an answer that cannot come: nobody offers the service, or the action."""
    ends: list[Any] = [end for live in lab.nodes.live for node in live.made for end in (*node.clients, *node.waitables)]
    client = next((end for end in ends if _waits_for(end, future)), None)
    if isinstance(client, Client) and not client.service_is_ready():
        raise not_found(lab.node, WantedServer(SERVES, client.service_name, type_name(client.srv_type)), _NO_SERVER_S)
    if isinstance(client, ActionClient) and not client.server_is_ready():
        name, kind = full_action_name(lab.node, client._action_name), type_name(client._action_type)  # noqa: SLF001
        raise not_found(lab.node, WantedServer(RUNS, name, kind), _NO_SERVER_S)


def _guard_awaits(patches: Patches, lab: Engine) -> None:
    original = Future.__await__

    def wait(future: Future) -> Generator[Any, None, Any]:
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            if lab.found.has(compat.PENDING_CALLS):
                _check_await(lab, future)
            return (yield from original(future))
        try:
            return (yield from _await_in_cell(lab, future).__await__())
        finally:
            lab.output.drain()

    patches.set(Future, "__await__", wait)


# Where the callback stands among the arguments, after the node.
_CALLBACKS = {"create_service": 2, "create_subscription": 2, "create_timer": 1, "add_on_set_parameters_callback": 0}
_CALLED = re.compile(r"(?P<name>\w+(?:\.\w+)*)\(\)")
_EXECUTE = 3  # the place of an action server's execute callback, after the server: node, type, name, callback


def _guard_callbacks(patches: Patches, locate: Locate) -> None:
    """Report what is no callback where it is given, not when it is used."""
    for method, place in _CALLBACKS.items():
        _require_callable(patches, Node, method, place, locate)
    _require_callable(patches, ActionServer, "__init__", _EXECUTE, locate, "execute_callback")


def _require_callable(  # noqa: PLR0913, PLR0917 - a method, where its callback is, and how cells are called
    patches: Patches, owner: Any, method: str, place: int, locate: Locate, option: str = "callback"
) -> None:
    original: Callable[..., Any] = getattr(owner, method)
    name = "ActionServer" if method == "__init__" else method

    @functools.wraps(original)
    def checked(subject: Any, *arguments: Any, **options: Any) -> Any:
        __tracebackhide__ = True  # IPython: the learner's own lines are what matters
        if place < len(arguments) or option in options:
            given = arguments[place] if place < len(arguments) else options[option]
            caller = _caller()
            if not callable(given) and caller is not None and is_own(caller.f_code.co_filename):
                where, line = own_line(caller.f_code.co_filename, caller.f_lineno, locate)
                raise CallbackError(_no_function(name, given, where, line))
        return original(subject, *arguments, **options)

    patches.set(owner, method, checked)


def _caller() -> FrameType | None:
    """Who has called, past the functions of the kit that stand in for rclpy's."""
    frame = inspect.currentframe()
    while frame is not None and frame.f_code.co_filename.startswith(str(environment.PACKAGE)):
        frame = frame.f_back
    return frame


def _no_function(method: str, given: object, where: str, line: str) -> str:
    what = "None" if given is None else with_article(type(given).__name__)
    called = _CALLED.search(line.partition("(")[2])
    meant = ""
    if called:
        meant = f" Without parentheses it is the function itself: write {called['name']}, not {called['name']}()."
    return f"{method}() was given {what} where it takes a function to call later ({where}: {line}).{meant}"
