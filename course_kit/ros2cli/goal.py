"""One goal, from sending to result; a Ctrl-C cancels it at the server before the command ends."""

from __future__ import annotations

import math
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.text import to_yaml

if TYPE_CHECKING:
    from typing_extensions import Self

    from course_kit.ros2cli.session import Session

_STATUS = {0: "UNKNOWN", 1: "ACCEPTED", 2: "EXECUTING", 3: "CANCELING", 4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}


class Goal:
    """A goal of one action.

    Args:
        session: the command's.
        node: its node.
        action_type: the action's class.
        name: the action's full name.
        timeout: seconds without any sign of the server after which it is given up.
    """

    def __init__(self, session: Session, node: Any, action_type: Any, name: str, timeout: float) -> None:
        from rclpy.action import ActionClient

        self._session, self._node, self._name, self._timeout = session, node, name, timeout
        self._client = ActionClient(node, action_type, name)
        self._heard = time.monotonic()
        self._early: list[Any] | None = []  # feedback that overtook the word that the goal is accepted

    def close(self) -> None:
        """Leave the action."""
        self._client.destroy()

    def run(self, goal: Any, *, show_feedback: bool) -> None:
        """Send the goal and print what comes, as the real command does.

        Raises:
            CommandError: no server, or it fell silent.
        """
        print("Waiting for an action server to become available...", flush=True)
        self._wait_for_server()
        print(f"Sending goal:\n     {to_yaml(goal)}", flush=True)
        callback = self._on_feedback if show_feedback else self._on_sign_of_life
        sent = self._client.send_goal_async(goal, feedback_callback=callback)
        silent = f"{self._name} has not said within {self._timeout:g} s whether it accepts the goal."
        handle = self._session.result_of(sent, self._timeout, silent)
        if not handle.accepted:
            print("Goal was rejected.")
            return
        print(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n\n", end="", flush=True)
        early, self._early = self._early or [], None
        for feedback in early:
            _print_feedback(feedback)
        result = handle.get_result_async()
        with _Interrupt() as interrupt:
            self._wait_for_result(result, interrupt)
        if not result.done():
            self._cancel(handle)
            self._wait_for_result(result)
        answer = result.result()
        print(f"Result:\n    {to_yaml(answer.result)}")
        print(f"Goal finished with status: {_STATUS.get(answer.status, answer.status)}")

    def _cancel(self, handle: Any) -> None:
        print("Canceling goal...\n", end="", flush=True)
        silent = f"{self._name} has not answered the request to cancel within {self._timeout:g} s."
        answer = self._session.result_of(handle.cancel_goal_async(), self._timeout, silent)
        if answer.goals_canceling:
            print("Goal canceled.\n", end="", flush=True)
        else:
            sys.stderr.write(f"{self._name} does not cancel the goal; waiting for its result.\n")

    def _wait_for_result(self, result: Any, interrupt: _Interrupt | None = None) -> None:
        """Wait as long as feedback comes; shown or not, it is the only sign that the goal is worked on."""
        self._heard = time.monotonic()

        def is_over() -> bool:
            if interrupt is not None and interrupt.seen:
                return True
            return bool(result.done()) or time.monotonic() - self._heard > self._timeout

        self._session.spin_until(is_over, math.inf)
        if not result.done() and not (interrupt is not None and interrupt.seen):
            raise CommandError(
                f"Neither feedback nor a result from {self._name} for {self._timeout:g} s; the goal has not been "
                "canceled. A longer wait: --timeout SECONDS."
            )

    def _wait_for_server(self) -> None:
        if self._session.wait_on_graph(self._client.server_is_ready, self._timeout):
            return
        from course_kit.ros2cli.graph import actions_among

        actions = actions_among(dict(self._node.get_topic_names_and_types()))
        hint = did_you_mean(self._name, set(actions) - {self._name})
        raise CommandError(f"No action server for {self._name} within {self._timeout:g} s.{hint}")

    def _on_sign_of_life(self, message: Any) -> None:
        del message
        self._heard = time.monotonic()

    def _on_feedback(self, message: Any) -> None:
        self._on_sign_of_life(message)
        if self._early is None:
            _print_feedback(message.feedback)
        else:
            self._early.append(message.feedback)


def _print_feedback(feedback: Any) -> None:
    # One piece, its line end included: another thread may print at the same time.
    print(f"Feedback:\n    {to_yaml(feedback)}\n", end="", flush=True)


class _Interrupt:
    """The first Ctrl-C as a fact; as an exception it would come inside a callback or a half-printed line.

    A second one is a KeyboardInterrupt again.
    """

    def __init__(self) -> None:
        self.seen = False
        self._before: Any = None

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._take)
        return self

    def __exit__(self, *error: object) -> None:
        self._restore()

    def _take(self, number: int, frame: object) -> None:
        del number, frame
        self.seen = True
        self._restore()

    def _restore(self) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
            self._before = None
