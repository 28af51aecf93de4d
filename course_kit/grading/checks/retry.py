"""Asks a server so that the answer comes, if the server gives one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.bounds import bounded

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.client import Client

    from course_kit.grading.checks.context import CheckContext

RESEND_AFTER_S = (
    1.0  # when nothing has come for so long it is asked again; also what a program that ends at once is given
)
_SOON_S = 0.5


class RetriedRequest:
    """A request that is sent a second time when no answer comes for a while.

    On a loaded machine the middleware drops a response as long as the server's process has not noticed the client
    (rmw_fastrtps waits 0.1 s for that); and an executor with several threads notices that a callback has raised with
    the next request only.
    """

    def __init__(
        self,
        context: CheckContext,
        request: Any,
        client: Client,
        again: Callable[[], Client],
        after_s: float = RESEND_AFTER_S,
    ) -> None:
        """Send it.

        Args:
            context: the context of the check.
            request: what is asked.
            client: whom by.
            again: gives the client for the second time.
            after_s: when that is.
        """
        self.clock = context.clock()
        self._request, self._again, self._after_s = request, again, after_s
        self._futures = [client.call_async(request)]

    def answered(self) -> bool:
        """Whether an answer has come; to be asked again and again."""
        if any(future.done() for future in self._futures):
            return True
        if len(self._futures) == 1 and self.clock.wall() > self._after_s:
            self._futures.append(self._again().call_async(self._request))
        return False

    def response(self) -> Any:
        """The first answer; None as long as there is none."""
        return next((bounded(future.result()) for future in self._futures if future.done()), None)


def wait_for_match(context: CheckContext, client: Client, request: Any, seconds: float = RESEND_AFTER_S) -> bool:
    """Ask until an answer has come, whatever it says: from then on the server's process knows the grader's clients.

    Args:
        context: the context of the check.
        client: the last one made; they are announced in the order of their making.
        request: what is asked.
        seconds: the patience.

    Raises:
        SubmissionEndedError: the submission has ended meanwhile.
    """
    return context.wait_until(RetriedRequest(context, request, client, lambda: client, _SOON_S).answered, seconds)
