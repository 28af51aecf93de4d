"""Execute callbacks on threads of their own: who is served meanwhile, and how they end."""

from __future__ import annotations

import asyncio
import re
import subprocess
import sys
import threading
from typing import TYPE_CHECKING, Any

import psutil
import pytest
import rclpy
from example_interfaces.action import Fibonacci
from std_srvs.srv import Trigger

from course_kit import lab
from tests.lab.action_nodes import Fibonaccis, Stubborn, Waiting

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab
    from tests.lab.kernel import Kernel

pytestmark = pytest.mark.usefixtures("own_lab")


def executing() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "ros-execute"]


def test_feedback_cancel_and_other_callbacks_are_served_meanwhile() -> None:
    node = lab.start(Waiting)

    async def follow() -> Any:
        goal = await lab.send_goal("/fibonacci", Fibonacci, order=40)
        assert repr(goal) == "Goal(order=40) for /fibonacci: accepted"
        async for feedback in goal:
            assert list(feedback.sequence) == [0, 1, 1]
            break
        assert goal.status == "EXECUTING"
        await lab.call("/ping", Trigger)
        assert not node.go_on.is_set()
        assert await goal.cancel() is True
        assert list((await goal.result()).sequence) == [0, 1, 1]
        return goal

    goal = asyncio.run(follow())
    assert goal.status == "CANCELED"
    assert goal.cancel_blocking() is False
    assert executing() == []


def test_a_server_may_refuse_to_cancel() -> None:
    node = lab.start(Stubborn)
    goal = lab.send_goal_blocking("/stubborn", Fibonacci, order=1)
    assert goal.cancel_blocking() is False
    assert goal.status in {"ACCEPTED", "EXECUTING"}
    node.release.set()
    assert list(goal.result_blocking().sequence) == [7]


def test_two_goals_are_executed_at_once() -> None:
    class Meeting(Fibonaccis):
        def __init__(self) -> None:
            super().__init__()
            self.barrier = threading.Barrier(2)

        def execute(self, goal: Any) -> Any:
            self.barrier.wait(10)
            return super().execute(goal)

    lab.start(Meeting)

    async def both() -> list[Any]:
        goals = [await lab.send_goal("/fibonacci", Fibonacci, order=order) for order in (2, 3)]
        return [list((await goal.result()).sequence) for goal in goals]

    assert asyncio.run(both()) == [[0, 1, 1], [0, 1, 1, 2]]


def test_a_goal_that_takes_too_long_says_where_it_is() -> None:
    node = lab.start(Stubborn)
    goal = lab.send_goal_blocking("/stubborn", Fibonacci, order=1)
    assert node.busy.wait(10)
    expected = (
        r"/stubborn did not finish the goal within 0.3 s. stubborn has been in execute "
        r"\(action_nodes.py, line \d+: .*\)(?: for [1-9]\d* s)?\."
    )
    with pytest.raises(lab.NoAnswerError, match=expected):
        goal.result_blocking(timeout=0.3)
    node.release.set()
    assert list(goal.result_blocking().sequence) == [7]  # it was only waited for too shortly


def test_a_server_that_is_stopped_loses_its_goals() -> None:
    lab.start(Waiting)
    ended: list[Any] = []
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=9, on_result=ended.append)
    lab.stop()
    assert executing() == []
    with pytest.raises(lab.NoAnswerError, match="went away: its program ended"):
        goal.result_blocking()
    assert goal.status == "UNKNOWN"
    assert ended == [goal]


def test_closing_the_lab_leaves_no_thread(own_lab: Lab) -> None:
    node = lab.start(Stubborn)
    goal = lab.send_goal_blocking("/stubborn", Fibonacci, order=1)
    assert node.busy.wait(10)
    own_lab.close()
    assert executing() == []
    assert goal.done


def test_an_execute_callback_may_call_and_wait() -> None:
    """As on a MultiThreadedExecutor: the answer is taken by another thread."""

    class Caller(Fibonaccis):
        def __init__(self) -> None:
            super().__init__()
            self.client = self.create_client(Trigger, "ping")

        def execute(self, goal: Any) -> Any:
            assert self.client.call(Trigger.Request()) is not None
            assert lab.call_blocking("/ping", Trigger) is not None
            return super().execute(goal)

    lab.start(Caller)
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=2)
    assert list(goal.result_blocking().sequence) == [0, 1, 1]


def test_an_execute_callback_that_waits_for_ever_can_be_stopped() -> None:
    class Caller(Fibonaccis):
        def __init__(self) -> None:
            super().__init__()
            self.client = self.create_client(Trigger, "nobody_serves_this")

        def execute(self, goal: Any) -> Any:
            self.first.set()
            self.client.call(Trigger.Request())
            return super().execute(goal)

    node = lab.start(Caller)
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=2)
    assert node.first.wait(10)
    lab.stop()
    assert not goal.done
    assert executing() == []


def test_spinning_for_ever_in_an_execute_callback_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    class Spinning(Fibonaccis):
        def execute(self, goal: Any) -> Any:
            rclpy.spin(self)
            return super().execute(goal)

    lab.start(Spinning)
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=2)
    goal.result_blocking()
    assert goal.status == "ABORTED"
    assert "never returns, so the goal would never end" in capsys.readouterr().err


def test_shutdown_in_an_execute_callback_stops_its_node_when_the_goal_has_ended() -> None:
    class Final(Fibonaccis):
        def execute(self, goal: Any) -> Any:
            rclpy.shutdown()
            return super().execute(goal)

    lab.start(Final)
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=2)
    assert list(goal.result_blocking().sequence) == [0, 1, 1]
    assert lab.nodes() == []


PROGRAM = """
import sys
from tests.lab.action_nodes import Stubborn
from example_interfaces.action import Fibonacci
from course_kit import lab
lab.start(Stubborn)
print(lab.send_goal_blocking("/stubborn", Fibonacci, order=1))
"""


def test_a_program_ends_although_a_goal_is_being_executed() -> None:
    for _ in range(3):
        ended = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, timeout=60, check=False)
        assert (ended.returncode, ended.stderr) == (0, "")
        assert ended.stdout == "Goal(order=1) for /stubborn: accepted\n"


SERVER = """
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.node import Node

class Chatty(Node):
    def __init__(self):
        super().__init__("chatty")
        ActionServer(self, Fibonacci, "chat", self.execute)

    def execute(self, goal):
        for number in range(goal.request.order):
            print("printed", end=" ")  # a line is not torn apart by another one
            self.get_logger().info(f"logged {number}")
            print(number)
        if goal.request.order == 2:
            raise ValueError("two")
        goal.succeed()
        return Fibonacci.Result()
lab.start(Chatty)
"""


def test_what_execute_callbacks_print_lands_in_the_cell_that_waits(kernel: Kernel) -> None:
    assert kernel.run(SERVER).ok
    shown = kernel.run("goal = await lab.send_goal('/chat', Fibonacci, order=3)\n_ = await goal.result()")
    lines = [f"[INFO] [chatty]: logged {number}\nprinted {number}\n" for number in range(3)]
    assert shown.stdout == "".join(lines)
    assert shown.stderr == ""
    shown = kernel.run("goal = await lab.send_goal('/chat', Fibonacci, order=2)\n_ = await goal.result()\ngoal")
    assert shown.result["text/plain"] == "Goal(order=2) for /chat: ABORTED"
    assert re.fullmatch(
        r"chatty: execute raised ValueError: two\n  In\[\d+\], line 16: raise ValueError\(\"two\"\)\n"
        r"  The node keeps running, and so do the others\.\n",
        shown.stderr,
    )


LONG = """
import time
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse
from rclpy.node import Node

class Long(Node):
    def __init__(self):
        super().__init__("long")
        ActionServer(self, Fibonacci, "long", self.execute, cancel_callback=lambda _: CancelResponse.ACCEPT)

    def execute(self, goal):
        while not goal.is_cancel_requested:
            goal.publish_feedback(Fibonacci.Feedback(sequence=[1]))
            time.sleep(0.02)
        goal.canceled()
        return Fibonacci.Result(sequence=[2])
lab.start(Long)
"""


def test_interrupting_a_cell_that_waits_for_a_goal(kernel: Kernel) -> None:
    assert kernel.run(LONG).ok
    assert kernel.run("goal = await lab.send_goal('/long', Fibonacci, order=1)").ok
    for code in ("await goal.result()", "goal.result_blocking()", "async for feedback in goal:\n    pass"):
        message = kernel.send("print('begun', flush=True)\n" + code)
        kernel.finish(message, until="begun")
        kernel.manager.interrupt_kernel()
        assert kernel.finish(message).error.startswith("Interrupted in In["), code
    shown = kernel.run(
        "assert len(goal.feedback) > 1\nprint(await goal.cancel(), (await goal.result()).sequence)\ngoal"
    )
    assert (shown.ok, shown.stdout) == (True, "True array('i', [2])\n"), shown
    assert shown.result["text/plain"] == "Goal(order=1) for /long: CANCELED"


def test_a_kernel_ends_cleanly_while_a_goal_is_being_executed(fresh_kernel: Kernel) -> None:
    fresh_kernel.run(LONG)
    assert fresh_kernel.run("goal = await lab.send_goal('/long', Fibonacci, order=1)").ok
    process = psutil.Process(fresh_kernel.pid)
    fresh_kernel.client.shutdown(restart=False)
    assert process.wait(timeout=20) in {0, None}
