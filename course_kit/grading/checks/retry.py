"""Asks a server so that the answer comes, if the server gives one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.bounds import bounded

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message
    from course_kit.ros.service import ServiceClient

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
        request: Message,
        client: ServiceClient,
        again: Callable[[], ServiceClient],
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
        self._again, self._after_s = again, after_s
        self._sent = client.send(request)

    def answered(self) -> bool:
        """Whether an answer has come; to be asked again and again."""
        if self._sent.answered():
            return True
        if self._sent.sent == 1 and self.clock.wall() > self._after_s:
            self._sent.send_again(self._again())
        return False

    def response(self) -> Message:
        """The first answer; None as long as there is none."""
        return bounded(self._sent.response()) if self._sent.answered() else None


def wait_for_match(
    context: CheckContext, client: ServiceClient, request: Message, seconds: float = RESEND_AFTER_S
) -> bool:
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
