"""What strangers' programs do, run in a cell: the lab does what the program would, and leaves nothing behind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.waiting import wait_until

if TYPE_CHECKING:
    from tests.lab.kernel import Kernel

OTHER = """
from course_kit import lab
from rclpy.node import Node
class Other(Node):
    def __init__(self):
        super().__init__("other")
lab.start(Other)
"""
LIGHT = """
import time
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

class Light(Node):
    def __init__(self):
        super().__init__("light")
        self.srv = self.create_service(Trigger, "flash", self.cb)

    def cb(self, request, response):
        response.success = True
        return response

def main(args=None):
    rclpy.init(args=args)
    node = Light()
    print("up")
    {spin}
"""
SPIN = "rclpy.spin(node)"
CAUGHT = "try:\n        rclpy.spin(node)\n    except KeyboardInterrupt:\n        pass"
SLEEPS = "time.sleep(60)"


def shown_by_stopped(kernel: Kernel, cell: str) -> str:
    """What a cell with an endless program has shown when it was stopped."""
    message = kernel.send(cell)
    kernel.finish(message, until="up")
    kernel.manager.interrupt_kernel()
    return kernel.finish(message).stdout


def require_nodes(kernel: Kernel, listed: str) -> None:
    """These nodes are there; `ros2` hears of a node's end a moment after it, as the real one does."""
    wait_until(lambda: kernel.run("%ros2 node list").stdout == listed, lambda: kernel.run("%ros2 node list").stdout)


@pytest.mark.parametrize("spin", [SPIN, SLEEPS])
def test_a_program_that_is_stopped_in_a_cell_takes_its_node_along(kernel: Kernel, spin: str) -> None:
    assert kernel.run(OTHER + LIGHT.replace("{spin}", spin)).ok
    for _ in range(2):
        said = shown_by_stopped(kernel, "main()")
        assert "light, which the lab did not run, is gone, as when a program ends.\n" in said
        require_nodes(kernel, "/other\n")


def test_it_does_so_before_the_lab_has_begun_and_by_run(fresh_kernel: Kernel) -> None:
    (fresh_kernel.cwd / "light.py").write_text(LIGHT.replace("{spin}", CAUGHT) + "\nmain()\n")
    shown_by_stopped(fresh_kernel, "%run light.py")
    require_nodes(fresh_kernel, "")
    assert fresh_kernel.run(OTHER).ok
    of_the_lab = "import rclpy\nprint(rclpy.get_global_executor().context is lab.nodes()[0].node.context)"
    assert fresh_kernel.run(of_the_lab).stdout == "True\n"  # by that of the first program nothing would be run
    shown_by_stopped(fresh_kernel, "%run light.py")
    require_nodes(fresh_kernel, "/other\n")


def test_a_program_that_fails_in_a_cell_takes_its_node_along(kernel: Kernel) -> None:
    assert kernel.run(OTHER + LIGHT.replace("{spin}", "1 / 0")).ok
    assert not kernel.run("main()").ok
    require_nodes(kernel, "/other\n")
    assert not kernel.run("import rclpy\nmine = rclpy.create_node('mine')\n1 / 0").ok  # a name leads to it
    require_nodes(kernel, "/mine\n/other\n")


ASKER = """
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from course_kit import lab
import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger

class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.create_service(Trigger, "answer", self.cb)

    def cb(self, request, response):
        response.message = "yes"
        return response

class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        self.cli = self.create_client(Trigger, "answer", callback_group={group})
        self.timer = self.create_timer(0.1, self.tick, callback_group={timers})

    def tick(self):
        self.timer.cancel()
        {ask}

lab.start(Server)
lab.start(Asker)
"""
CALL = 'print("got", self.cli.call(Trigger.Request()).message)'
SPIN_UNTIL = """future = self.cli.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(self, future)
        print("got", future.result().message)"""
OWN_NODE = """node = rclpy.create_node("helper")
        future = node.create_client(Trigger, "answer").call_async(Trigger.Request())
        rclpy.spin_until_future_complete(node, future)
        print("got", future.result().message)"""
GROUP = "MutuallyExclusiveCallbackGroup()"


@pytest.mark.parametrize(
    ("ask", "group", "timers", "said"),
    [
        (CALL, GROUP, "None", "MultiThreadedExecutor"),
        (SPIN_UNTIL, GROUP, "None", "would lose the node"),
        (OWN_NODE, "None", "None", ""),
    ],
)
def test_a_callback_waits_for_an_answer_where_a_program_could(
    kernel: Kernel, ask: str, group: str, timers: str, said: str
) -> None:
    cell = ASKER.replace("{ask}", ask).replace("{group}", group).replace("{timers}", timers)
    message = kernel.send(f"{cell}\nimport asyncio\nwhile True: await asyncio.sleep(0.05)")
    shown = kernel.finish(message, until="got yes")
    assert "got yes" in shown.stdout, shown
    assert said in shown.stdout
    kernel.manager.interrupt_kernel()
    kernel.finish(message)


def test_an_execute_callback_may_spin_its_node(kernel: Kernel) -> None:
    shown = kernel.run(
        """
import rclpy
from course_kit import lab
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.node import Node

class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.server = ActionServer(self, Fibonacci, "fibonacci", self.execute)

    def execute(self, goal_handle):
        rclpy.spin_once(self, timeout_sec=0.01)
        goal_handle.succeed()
        return Fibonacci.Result(sequence=[1])

lab.start(Server)
goal = await lab.send_goal("/fibonacci", Fibonacci, order=1)
print((await goal.result()).sequence)
"""
    )
    assert shown.ok, shown.error
    assert shown.stdout.endswith("[1])\n"), shown
    assert "would lose the node" in shown.stdout


def test_a_line_of_a_newer_ros_is_called_so(fresh_kernel: Kernel) -> None:
    program = "import rclpy\nwith rclpy.init():\n    pass"
    said = "This line belongs to a newer ROS 2."
    assert said in fresh_kernel.run(program).error
    assert fresh_kernel.run("from course_kit import lab\nlab.current().engine").ok
    assert said in fresh_kernel.run(program).error
    assert said in fresh_kernel.run(f"%%ros_script newer\n{program}").stdout
