"""`ros2 action`: list, type, info, send_goal; a Ctrl-C cancels the goal at the server before the command ends."""

from __future__ import annotations

import math
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from course_kit.ros.graph import RUNS, SENDS_GOALS
from course_kit.ros.messages import type_name
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.graph import Graph, visible_names
from course_kit.ros2cli.parser import add_graph_options, add_named, add_timeout, add_values, add_verbs
from course_kit.ros2cli.session import CommandError, Session
from course_kit.ros2cli.text import to_yaml
from course_kit.ros2cli.verbs._listing import add_about, add_list, add_type, checked_name, graph_of, print_names

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from rclpy.node import Node
    from typing_extensions import Self

    from course_kit.ros.goal import GoalTracker
    from course_kit.ros.messages import ActionType, Message

_PROOF_S = 1.0


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    add_graph_options(add_list(verbs, "action", _list, hidden=False))
    add_type(verbs, "action", Graph.actions)
    info = add_about(verbs, "action", "info", _info, "Show who serves an action and who uses it")
    info.add_argument("-t", "--show-types", action="store_true", help="with the types")
    info.add_argument("-c", "--count", action="store_true", help="only how many there are")
    add_graph_options(info)
    goal = add_about(verbs, "action", "send_goal", _send_goal, "Send a goal; Ctrl-C cancels it")
    add_named(goal, "action_type", "action_types", help="such as example_interfaces/action/Fibonacci")
    add_values(goal, "goal", "the goal's fields as YAML, such as '{order: 5}'")
    goal.add_argument("-f", "--feedback", action="store_true", help="show the feedback as it comes")
    add_timeout(goal, "seconds to wait at most for the server, for its decision, and for each message after that")


def _list(options: Namespace, session: Session) -> None:
    print_names(visible_names(graph_of(options, session).actions()), options)


def _info(options: Namespace, session: Session) -> None:
    name = checked_name(options.action_name)
    graph = graph_of(options, session)
    print(f"Action: {name}")
    for title, nodes in (("clients", graph.nodes_on(name, SENDS_GOALS)), ("servers", graph.nodes_on(name, RUNS))):
        print(f"Action {title}: {len(nodes)}")
        if not options.count:
            for node, types in sorted(nodes.items()):
                print(f"    {node} [{', '.join(types)}]" if options.show_types else f"    {node}")
    if name not in graph.actions() and (hint := did_you_mean(name, graph.actions())):
        sys.stderr.write(f"There is no action {name}.{hint}\n")  # zeros and exit code 0 are the real command's


def _send_goal(options: Namespace, session: Session) -> None:
    from course_kit.ros2cli import values

    name = checked_name(options.action_name)
    node = session.node  # before the type is imported: the graph is being discovered meanwhile
    action_type = values.find_type(options.action_type, "action")
    goal = action_type.Goal()
    values.fill_message(goal, values.read_typed(options, "goal"), f"{type_name(action_type)}_Goal")
    sending = _SentGoal(session, node, action_type, name, options.timeout)
    try:
        sending.run(goal, show_feedback=options.feedback)
    finally:
        sending.close()


class _SentGoal:
    """A goal of one action."""

    def __init__(self, session: Session, node: Node, action_type: ActionType, name: str, timeout: float) -> None:
        from course_kit.ros.goal import GoalClient

        self._session, self._node, self._name, self._timeout = session, node, name, timeout
        self._client = GoalClient(node, action_type, name)
        self._result_type = action_type.Impl.GetResultService
        self._seen = 0  # feedback messages

    def close(self) -> None:
        """Leave the action."""
        self._client.destroy()

    def run(self, goal: Message, *, show_feedback: bool) -> None:
        """Send the goal and print what comes, as the real command does."""
        from course_kit.ros.goal import GoalTracker

        print("Waiting for an action server to become available...", flush=True)
        self._wait_for_server()
        if show_feedback:
            self._wait_until_heard()
        print(f"Sending goal:\n     {to_yaml(goal)}", flush=True)
        tracker = GoalTracker(self._client, goal)
        tracker.begin()
        if not self._session.spin_until(lambda: tracker.accepted is not None, self._timeout):
            raise CommandError(f"{self._name} has not said within {self._timeout:g} s whether it accepts the goal.")
        if not tracker.accepted:
            print("Goal was rejected.")
            return
        print(f"Goal accepted with ID: {tracker.identifier.hex()}\n\n", end="", flush=True)
        with _Interrupt() as interrupt:
            self._follow(tracker, interrupt, show_feedback=show_feedback)
        if not tracker.ended:
            self._cancel(tracker)
            self._follow(tracker, show_feedback=show_feedback)
        if tracker.result is None:
            raise CommandError(
                f"{self._name} went away before the goal ended: its program has ended. Its own output says why."
            )
        print(f"Result:\n    {to_yaml(tracker.result)}")
        print(f"Goal finished with status: {tracker.status}")

    def _cancel(self, tracker: GoalTracker) -> None:
        print("Canceling goal...\n", end="", flush=True)
        answers: list[bool] = []
        tracker.cancel(answers.append)
        if not self._session.spin_until(lambda: bool(answers), self._timeout):
            raise CommandError(f"{self._name} has not answered the request to cancel within {self._timeout:g} s.")
        if answers[0]:
            print("Goal canceled.\n", end="", flush=True)
        else:
            sys.stderr.write(f"{self._name} does not cancel the goal; waiting for its result.\n")

    def _follow(self, tracker: GoalTracker, interrupt: _Interrupt | None = None, *, show_feedback: bool) -> None:
        """Wait as long as feedback comes; shown or not, it is the only sign that the goal is worked on."""
        heard = time.monotonic()

        def is_over() -> bool:
            nonlocal heard
            for feedback in tracker.feedback[self._seen :]:
                heard, self._seen = time.monotonic(), self._seen + 1
                if show_feedback:  # one piece, its line end included: another thread may print at the same time
                    print(f"Feedback:\n    {to_yaml(feedback)}\n", end="", flush=True)
            if interrupt is not None and interrupt.seen:
                return True
            return tracker.ended or time.monotonic() - heard > self._timeout

        self._session.spin_until(is_over, math.inf)
        if not tracker.ended and not (interrupt is not None and interrupt.seen):
            raise CommandError(
                f"Neither feedback nor a result from {self._name} for {self._timeout:g} s; the goal has not been "
                "canceled. A longer wait: --timeout SECONDS."
            )

    def _wait_for_server(self) -> None:
        if self._session.wait_on_graph(self._client.has_server, self._timeout):
            return
        from course_kit.ros import graph

        hint = did_you_mean(self._name, set(graph.offered_types(self._node, graph.RUNS)) - {self._name})
        raise CommandError(f"No action server for {self._name} within {self._timeout:g} s.{hint}")

    def _wait_until_heard(self) -> None:
        """Wait until the server knows the reader of its feedback: else that of a short goal would be lost.

        A server learns of endpoints in the order in which they were made. So an answer to a client made after the
        reader proves it; the question is for the result of a goal that nobody sent. A busy server gets the goal anyway.
        """
        asking = self._node.create_client(self._result_type, f"{self._client.action_name}/_action/get_result")
        try:
            self._session.wait_on_graph(asking.service_is_ready, _PROOF_S)
            self._session.spin_until(asking.call_async(self._result_type.Request()).done, _PROOF_S)
        finally:
            self._node.destroy_client(asking)


class _Interrupt:
    """The first Ctrl-C as a fact; as an exception it would come inside a callback or a half-printed line."""

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
