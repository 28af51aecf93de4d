"""The Stop button, pressed at random moments: `python benchmarks/interrupts.py [HOW_MANY]`.

One kernel for each way of waiting, and a cell that waits over and over for what comes all the time. So most interrupts
arrive while something has just come: where a wait may lose one. An interrupt is lost if the cell still runs 10 s later.
"""

from __future__ import annotations

import os
import queue
import random
import sys
import tempfile
import time

from jupyter_client.manager import KernelManager

from course_kit import environment

HOW_MANY = 300  # for all ways of waiting together
_GIVEN_UP = 10.0  # seconds
_START = 60.0
SETUP = """
%load_ext course_kit
from course_kit import lab
from rclpy.node import Node
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from std_msgs.msg import String
from std_srvs.srv import Trigger

class Busy(Node):
    def __init__(self):
        super().__init__("busy")
        self.publisher = self.create_publisher(String, "words", 10)
        self.create_timer(0.001, lambda: self.publisher.publish(String(data="word")))
        self.create_service(Trigger, "now", lambda request, response: response)
        self.declare_parameter("speed", 1)
        ActionServer(self, Fibonacci, "count", self.count)

    def count(self, handle):
        for _ in range(3):
            handle.publish_feedback(Fibonacci.Feedback())
        handle.succeed()
        return Fibonacci.Result()

busy = lab.start(Busy)
client = busy.create_client(Trigger, "now")
"""
WAITS = {
    "next_messages": "await lab.next_messages('/words', String, 1)",
    "call": "await lab.call('/now', Trigger)",
    "call_async": "await client.call_async(Trigger.Request())",
    "set_parameters": "await lab.set_parameters('busy', speed=2)",
    "result of a goal": "await (await lab.send_goal('/count', Fibonacci, order=1)).result()",
    "feedback of a goal": "async for feedback in await lab.send_goal('/count', Fibonacci, order=1): pass",
}


class Kernel:
    """A kernel with the node above."""

    def __init__(self) -> None:
        self._manager = KernelManager()
        self._manager.start_kernel(cwd=tempfile.gettempdir(), env=dict(os.environ))
        self._client = self._manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=_START)
        started = self._client.execute(SETUP)
        assert self._has_ended(started, _START), "the kernel does not start"  # noqa: S101

    def close(self) -> None:
        """End it."""
        self._client.stop_channels()
        self._manager.shutdown_kernel(now=True)
        self._manager.cleanup_resources()

    def is_stopped(self, wait: str, after: float) -> bool:
        """Whether one interrupt, `after` seconds after the first round, ends a cell that waits for ever."""
        message = self._client.execute(f"print('begun')\nwhile True:\n    {wait}")
        self._shown(message, "stream", _START)
        time.sleep(after)
        self._manager.interrupt_kernel()
        return self._has_ended(message, _GIVEN_UP)

    def _has_ended(self, message: str, within: float) -> bool:
        return self._shown(message, "status", within)

    def _shown(self, message: str, kind: str, within: float) -> bool:
        deadline = time.monotonic() + within
        while time.monotonic() < deadline:
            try:
                got = self._client.get_iopub_msg(timeout=max(0.01, deadline - time.monotonic()))
            except queue.Empty:
                break
            state = got["content"].get("execution_state", "idle")
            if got["parent_header"].get("msg_id") == message and got["msg_type"] == kind and state == "idle":
                return True
        return False


def lost(wait: str, how_many: int, rng: random.Random) -> int:
    """How many of some interrupts one way of waiting has lost."""
    kernel, missing = Kernel(), 0
    try:
        for _ in range(how_many):
            if not kernel.is_stopped(wait, rng.uniform(0.0, 0.1)):
                missing += 1
                kernel.close()
                kernel = Kernel()
    finally:
        kernel.close()
    return missing


def main() -> int:
    """Print the table; the exit code says whether any was lost."""
    each = (int(sys.argv[1]) if len(sys.argv) > 1 else HOW_MANY) // len(WAITS)
    print(f"Python {sys.version.split()[0]}, {each} interrupts each\n\n  {'':<20} lost")
    total = 0
    with environment.exclusive_domain() as domain_id:
        os.environ["ROS_DOMAIN_ID"] = str(domain_id)
        for name, wait in WAITS.items():
            missing = lost(wait, each, random.Random(name))  # noqa: S311
            total += missing
            print(f"  {name:<20} {missing:>4}", flush=True)
    print(f"\n{total} of {each * len(WAITS)} lost: {'met' if not total else 'MISSED'} (aim: none)")
    return 1 if total else 0


if __name__ == "__main__":
    sys.exit(main())
