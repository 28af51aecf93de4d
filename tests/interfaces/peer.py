"""One of two processes that exchange test_msgs and std_srvs; each uses compiled or live types.

    python peer.py server|client compiled|live FOLDER

FOLDER holds copies of the definitions, which the live side imports in place of the installed packages.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

TOPICS = "Arrays BasicTypes BoundedSequences Builtins Defaults Empty MultiNested Nested Strings WStrings"
DEADLINE = 20.0


def use_live_types(folder: str) -> None:
    """Let the definitions in a folder win over installed packages; the course itself never does this."""
    from course_kit.interfaces import finder

    os.environ["COURSE_KIT_INTERFACE_PATH"] = folder
    ours = finder.get_finder()
    sys.meta_path.remove(ours)
    sys.meta_path.insert(0, ours)


class Server:
    """Answers whatever it is asked, and sends back each message it gets."""

    def __init__(self, node: Any) -> None:
        from rclpy.action import ActionServer, CancelResponse, GoalResponse
        from rclpy.callback_groups import ReentrantCallbackGroup
        from std_srvs.srv import SetBool
        from test_msgs import msg as messages
        from test_msgs.action import Fibonacci, NestedMessage
        from test_msgs.srv import Arrays

        self.fibonacci, self.nested = Fibonacci, NestedMessage
        group = ReentrantCallbackGroup()
        node.create_service(SetBool, "switch", self.switch, callback_group=group)
        node.create_service(Arrays, "arrays", self.arrays, callback_group=group)
        for name in TOPICS.split():
            cls = getattr(messages, name)
            publisher = node.create_publisher(cls, f"back_{name}", 10)
            node.create_subscription(cls, f"to_{name}", publisher.publish, 10, callback_group=group)
        self.actions = [
            ActionServer(
                node,
                Fibonacci,
                "fibonacci",
                self.compute,
                goal_callback=lambda goal: GoalResponse.REJECT if goal.order > 1000 else GoalResponse.ACCEPT,
                cancel_callback=lambda _: CancelResponse.ACCEPT,
                callback_group=group,
            ),
            ActionServer(node, NestedMessage, "nested", self.nest, callback_group=group),
        ]

    def switch(self, request: Any, response: Any) -> Any:
        response.success, response.message = request.data, "switched ✓"
        return response

    def arrays(self, request: Any, response: Any) -> Any:
        for name in response.get_fields_and_field_types():
            setattr(response, name, getattr(request, name))
        return response

    def compute(self, goal: Any) -> Any:
        feedback = self.fibonacci.Feedback(sequence=[0, 1])
        while len(feedback.sequence) <= goal.request.order:
            if goal.is_cancel_requested:
                goal.canceled()
                return self.fibonacci.Result(sequence=feedback.sequence)
            feedback.sequence.append((feedback.sequence[-1] + feedback.sequence[-2]) & 0x7FFFFFFF)
            goal.publish_feedback(feedback)
            threading.Event().wait(0.01)
        goal.succeed()
        return self.fibonacci.Result(sequence=feedback.sequence)

    def nest(self, goal: Any) -> Any:
        feedback = self.nested.Feedback()
        feedback.nested_different_pkg.sec = goal.request.nested_different_pkg.sec
        goal.publish_feedback(feedback)
        goal.succeed()
        return self.nested.Result(nested_field_no_pkg=goal.request.nested_field_no_pkg)

    def close(self) -> None:
        for action in self.actions:
            action.destroy()


class Client:
    """Uses everything the server offers and checks each answer.

    It spins its node itself: rclpy's action clients lose replies when they are used beside a spinning thread.
    """

    def __init__(self, node: Any) -> None:
        from rclpy.executors import SingleThreadedExecutor

        from tests.interfaces.twins import seeded

        self.node, self.random, self.executor = node, seeded(7), SingleThreadedExecutor()
        self.executor.add_node(node)

    def run(self) -> None:
        self.topics()
        self.services()
        self.fibonacci()
        self.nested_action()
        self.hashes()

    def wait_for(self, what: str, condition: Callable[[], Any]) -> None:
        end = time.monotonic() + DEADLINE
        while not condition():
            assert time.monotonic() < end, f"waited {DEADLINE} s for {what}"
            self.executor.spin_once(timeout_sec=0.05)

    def result(self, future: Any, what: str) -> Any:
        self.wait_for(what, future.done)
        return future.result()

    def topics(self) -> None:
        from test_msgs import msg as messages

        from tests.interfaces.twins import random_message

        for name in TOPICS.split():
            cls, got = getattr(messages, name), []
            self.node.create_subscription(cls, f"back_{name}", got.append, 10)
            publisher = self.node.create_publisher(cls, f"to_{name}", 10)
            self.wait_for(f"a subscription to {name}", publisher.get_subscription_count)
            # What is sent before both ends know each other is lost; so first something that does not count.
            self.wait_for(f"a first {name}", lambda p=publisher, c=cls, g=got: p.publish(c()) or g)
            sent = [random_message(cls, self.random) for _ in range(5)]
            for message in sent:
                publisher.publish(message)
            wanted = {repr(message) for message in sent}
            self.wait_for(f"{name} to come back", lambda w=wanted, g=got: w <= {repr(message) for message in g})
            assert {repr(message) for message in got} <= wanted | {repr(cls())}

    def services(self) -> None:
        from std_srvs.srv import SetBool
        from test_msgs.srv import Arrays

        from tests.interfaces.twins import random_message

        client = self.node.create_client(Arrays, "arrays")
        self.wait_for("/arrays", client.service_is_ready)
        for _ in range(10):
            request = random_message(Arrays.Request, self.random)
            answer = self.result(client.call_async(request), "/arrays")
            assert repr(answer).partition("(")[2] == repr(request).partition("(")[2]
        switch = self.node.create_client(SetBool, "switch")
        self.wait_for("/switch", switch.service_is_ready)
        answer = self.result(switch.call_async(SetBool.Request(data=True)), "/switch")
        assert (answer.success, answer.message) == (True, "switched ✓")

    def fibonacci(self) -> None:
        from rclpy.action import ActionClient
        from test_msgs.action import Fibonacci

        client = ActionClient(self.node, Fibonacci, "fibonacci")
        self.wait_for("/fibonacci", client.server_is_ready)
        feedback: list[list[int]] = []
        goal = self.result(
            client.send_goal_async(Fibonacci.Goal(order=10), lambda m: feedback.append(list(m.feedback.sequence))),
            "a goal's acceptance",
        )
        assert goal.accepted
        sequence = list(self.result(goal.get_result_async(), "a result").result.sequence)
        assert sequence == [0, 1, 1, 2, 3, 5, 8, 13, 21, 34, 55]
        assert feedback
        assert all(part == sequence[: len(part)] for part in feedback)
        endless = self.result(client.send_goal_async(Fibonacci.Goal(order=900)), "a goal's acceptance")
        assert len(self.result(endless.cancel_goal_async(), "cancelling").goals_canceling) == 1
        assert self.result(endless.get_result_async(), "the result of a cancelled goal").status == 5
        assert not self.result(client.send_goal_async(Fibonacci.Goal(order=1001)), "a goal's rejection").accepted

    def nested_action(self) -> None:
        from rclpy.action import ActionClient
        from test_msgs.action import NestedMessage

        from tests.interfaces.twins import random_message

        client = ActionClient(self.node, NestedMessage, "nested")
        self.wait_for("/nested", client.server_is_ready)
        wanted = random_message(NestedMessage.Goal, self.random)
        goal = self.result(client.send_goal_async(wanted), "a goal's acceptance")
        answer = self.result(goal.get_result_async(), "a result").result
        assert repr(answer.nested_field_no_pkg) == repr(wanted.nested_field_no_pkg)

    def hashes(self) -> None:
        """Both sides announce the same type under each name."""
        for name in [f"/back_{name}" for name in TOPICS.split()] + ["rq/arraysRequest", "rr/arraysReply"]:
            plain = not name.startswith("/")
            ends = self.node.get_publishers_info_by_topic(name, no_mangle=plain)
            ends += self.node.get_subscriptions_info_by_topic(name, no_mangle=plain)
            assert len(ends) == 2, (name, ends)
            assert len({str(end.topic_type_hash) for end in ends}) == 1, name


def serve(node: Any) -> None:
    """Answer until standard input is closed."""
    from rclpy.executors import MultiThreadedExecutor

    server, executor = Server(node), MultiThreadedExecutor(4)
    executor.add_node(node)
    stopping = threading.Event()

    def spin() -> None:
        while not stopping.is_set():  # rclpy's own spin() may miss the one wake-up that shutdown() gives, and wait on
            executor.spin_once(timeout_sec=0.1)

    thread = threading.Thread(target=spin)
    thread.start()
    sys.stdin.read()
    stopping.set()
    thread.join()
    executor.shutdown()
    server.close()


def main(role: str, how: str, folder: str) -> None:
    if how == "live":
        use_live_types(folder)
    import faulthandler

    import rclpy
    from test_msgs.msg import Arrays

    from course_kit.interfaces.message_fields import record_of

    faulthandler.dump_traceback_later(70, exit=True)  # a hang ends with a stack trace
    assert (record_of(Arrays) is not None) == (how == "live")
    rclpy.init()
    node = rclpy.create_node(role)
    if role == "server":
        serve(node)
    else:
        Client(node).run()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
