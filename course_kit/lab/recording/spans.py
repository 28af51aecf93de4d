"""Reports when a thread is inside a callback: from when to when, on which thread.

A callback that awaits gives its thread back meanwhile, so what is reported are the pieces between its awaits.
"""

from __future__ import annotations

import os
import threading
from typing import TYPE_CHECKING, Any

from course_kit.ros.names import is_hidden, is_of_every_node

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine, Generator

    from rclpy.executors import Executor
    from rclpy.timer import Timer

    from course_kit.lab.recording.events import EventStream

    Work = Callable[[], Coroutine[object, None, None]]
    Where = tuple[str, str, str]

_NODE = "_course_kit_node"  # on a timer: the name of its node


class CallbackSpans:
    """Reports pieces of callbacks as events: where, and as its value the thread, the process, and what is called."""

    def __init__(self, events: EventStream) -> None:
        self._events = events
        self._count = 0
        self._counting = threading.Lock()

    def around(self, work: Work, where: Where, what: str) -> Work:
        """The same work, reported while it runs."""
        if not self._events or is_of_every_node(where[1]):
            return work

        async def reported() -> None:
            await self.steps(work(), where, what)

        return reported

    def steps(self, awaitable: Awaitable[Any], where: Where, what: str) -> _Steps:
        """What is to be awaited instead of something, so that its pieces are reported."""
        return _Steps(self, awaitable, where, what)

    def begin(self, where: Where, what: str) -> int:
        """Report that the thread is inside a callback from now on; returns the number of this piece."""
        with self._counting:
            self._count += 1
            number = self._count
        thread = threading.current_thread()
        value = {"what": what, "thread": thread.name, "ident": threading.get_ident(), "process": os.getpid()}
        self._events.emit("callback_begun", where, value, number)
        return number

    def end(self, number: int, where: Where, *, failed: bool) -> None:
        """Report that it is outside again."""
        self._events.emit("callback_ended", where, {"failed": failed, "process": os.getpid()}, number)


class _Steps:
    """Drives something awaitable and reports each of its steps."""

    def __init__(self, spans: CallbackSpans, awaitable: Awaitable[Any], where: Where, what: str) -> None:
        self._spans, self._awaitable, self._where, self._what = spans, awaitable, where, what

    def __await__(self) -> Generator[Any, Any, Any]:
        steps: Any = self._awaitable.__await__()
        sent = None
        try:
            while True:
                failed = True
                number = self._spans.begin(self._where, self._what)
                try:
                    awaited = steps.send(sent) if hasattr(steps, "send") else next(steps)
                    failed = False
                except StopIteration as end:
                    failed = False
                    return end.value
                finally:
                    self._spans.end(number, self._where, failed=failed)
                sent = yield awaited
        finally:
            if hasattr(steps, "close"):
                steps.close()


def timer_work(spans: CallbackSpans, executor: Executor, timer: Timer, work: Work | None) -> Work | None:
    """The work of a timer, reported while it runs."""
    if work is None:
        return None
    node = vars(timer).get(_NODE)
    if node is None:
        owners = [one for one in executor.get_nodes() if any(timer is own for own in one.timers)]
        node = owners[0].get_fully_qualified_name() if owners else ""
        setattr(timer, _NODE, node)
    if not node or is_hidden(node):  # the lab's own
        return work
    return spans.around(work, (node, getattr(timer.callback, "__name__", "timer"), ""), "timer")
