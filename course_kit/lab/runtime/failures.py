"""Telling of callbacks that fail: once each, in a few lines, and to whoever waits for their answer."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from course_kit.lab.errors import DeadlockError, ServiceFailedError
from course_kit.lab.recording.hooks import WrongResultError
from course_kit.lab.runtime.callback_errors import Crash, examine
from course_kit.lab.runtime.describe import is_alive
from course_kit.lab.runtime.executor import Turn
from course_kit.ros.names import short_name

if TYPE_CHECKING:
    from rclpy.client import Client
    from rclpy.service import Service
    from rclpy.task import Future

    from course_kit.lab.notebook.output import Output
    from course_kit.lab.recording.hooks import MessageHooks
    from course_kit.lab.runtime.callback_errors import Locate
    from course_kit.lab.runtime.engine import Engine

_SHOWN = "_shown_by_course_kit"  # on an exception: it has been
_REPEATS = 3  # times the same error of the same callback is shown in a row


class Failures:
    """Told by the executor of callbacks that fail."""

    def __init__(self, output: Output, locate: Locate, hooks: MessageHooks, lab: Engine) -> None:
        self._output = output
        self._locate = locate
        self._hooks = hooks
        self._lab = lab
        self._last_crash: tuple[Crash | None, int] = (None, 0)

    def forget(self) -> None:
        """A node is about to be destroyed: the same error of the one in its place is news."""
        self._last_crash = (None, 0)

    def callback_crashed(self, error: BaseException, turn: Turn) -> None:
        """Say what went wrong in a callback, in three lines; the same error over and over is said three times."""
        if getattr(error, _SHOWN, False):
            return
        with contextlib.suppress(Exception):  # a class of the learner's may allow none
            setattr(error, _SHOWN, True)
        node = turn.node
        if node is self._lab.hidden_node:
            node = None
        crash = examine(error, turn if turn.entity is None else turn.entity, node, self._locate)
        if node is not None and not is_alive(node):
            return  # the rest of a node that was stopped in the middle
        before, times = self._last_crash
        times = times + 1 if crash == before else 1
        self._last_crash = (crash, times)
        if times > _REPEATS:
            return
        ending = _consequence(error, turn)
        if times == _REPEATS:
            ending += " (This keeps happening and will not be shown again.)"
        self._output.put(crash.text(ending), "stderr")

    def request_failed(self, service: Service, sequence: int, error: BaseException) -> None:
        """Give the one who waits for this answer an error, if it is a client in this lab."""
        turn = self._lab.turn()
        if turn is not None:  # before its caller goes on, so that the two are shown in this order
            self.callback_crashed(error, Turn(service, turn.node, turn.since))
        crash = examine(error, service, None, self._locate)
        owner = short_name(self._hooks.where(service)[0])
        place = f" ({crash.place})" if crash.place else ""
        text = f"{owner} sent no response: {crash.callback or 'its callback'} {crash.error}{place}"
        asking = [client for client in self._lab.all_clients() if client.service_name == service.service_name]
        waiting = [future for client in asking if (future := _pending(client, sequence)) is not None]
        if len(waiting) == 1:  # two clients may have used the same number; then each waits for its timeout
            waiting[0].set_exception(ServiceFailedError(text))
            waiting[0].exception()  # marks it as seen: a caller that lost interest is no news


def _pending(client: Client, sequence: int) -> Future | None:
    """The future of a request. A client holds its lock from sending until there is one: the answer may be sooner."""
    with client._lock:  # noqa: SLF001
        return client._pending_requests.get(sequence)  # noqa: SLF001


def _consequence(error: BaseException, turn: Turn) -> str:
    if turn.follows:
        return turn.follows
    if isinstance(error, DeadlockError):
        return "Nothing hangs here; in a separate program this callback would wait for ever."
    if turn.entity is not None and hasattr(turn.entity, "send_response"):
        return "The caller gets no answer. In a separate program this would end the server; here it keeps running."
    if isinstance(error, WrongResultError):
        return "The client gets an empty result. In a separate program it would wait for ever."
    return "The node keeps running, and so do the others."
