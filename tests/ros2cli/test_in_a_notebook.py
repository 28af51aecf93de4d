"""`%ros2` and `!ros2` in a real kernel, against a node of its lab."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator

NODE = """
from course_kit import lab
from rclpy.node import Node
from std_srvs.srv import SetBool

class Switch(Node):
    def __init__(self):
        super().__init__("switch")
        self.declare_parameter("speed", 1.0)
        self.create_service(SetBool, "power", self.power)

    def power(self, request, response):
        self.get_logger().info("asked")
        response.success = request.data
        return response

lab.start(Switch)
"""
FAULTY = """
class Faulty(Node):
    def __init__(self):
        super().__init__("faulty")
        self.declare_parameter("speed", 1.0)
        self.add_on_set_parameters_callback(self.check)
        self.create_service(SetBool, "fail", self.fail)

    def check(self, parameters):
        raise ValueError("too fast")

    def fail(self, request, response):
        return None

lab.start(Faulty)
"""
SYSTEM_PATH = "/usr/local/bin:/usr/bin:/bin"  # as of a kernel that an editor starts: without the course's programs
SCRIPTS = str(Path(sys.executable).parent)
CALL = "service call /power std_srvs/srv/SetBool '{data: true}'"


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    with environment.exclusive_domain() as domain_id, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain_id))
        patch.setenv("PATH", SYSTEM_PATH)
        with Kernel(cwd=tmp_path_factory.mktemp("kernel")) as running:
            assert running.run("%load_ext course_kit").ok
            assert running.run(NODE).ok
            yield running


def test_the_magic_lists_and_calls_and_the_nodes_log_lands_in_the_cell(kernel: Kernel) -> None:
    kernel.run("from course_kit import lab\nawait lab.call('/nobody', SetBool, timeout=0.1)")  # keeps its client
    assert kernel.run("%ros2 service list").stdout.splitlines()[0] == "/power"
    called = kernel.run(f"%ros2 {CALL}")
    assert "response:\nstd_srvs.srv.SetBool_Response(success=True, message='')" in called.stdout
    assert "[INFO] [switch]: asked" in called.stdout


def test_the_command_after_an_exclamation_mark_meets_the_same_node(kernel: Kernel) -> None:
    assert "/power" in kernel.run("!ros2 service list").stdout.split()
    assert "success=True" in kernel.run(f"!ros2 {CALL}").stdout
    assert "Set parameter successful" in kernel.run("!ros2 param set /switch speed 2.5").stdout
    assert kernel.run("%ros2 param get /switch speed").stdout == "Double value is: 2.5\n"


@pytest.mark.parametrize(
    "cell",
    [
        "!which ros2 python",
        "%%bash\nwhich ros2 python",
        "import subprocess\nsubprocess.run(['which', 'ros2', 'python'])",
    ],
)
def test_programs_of_the_kernels_own_python_come_first(kernel: Kernel, cell: str) -> None:
    assert kernel.run(cell).stdout.splitlines() == [f"{SCRIPTS}/ros2", f"{SCRIPTS}/python"]


def test_a_slip_is_one_line_and_no_traceback(kernel: Kernel) -> None:
    slipped = kernel.run("%ros2 servce list")
    assert slipped.ok
    assert slipped.stderr == "ros2: argument command: there is no 'servce'. Did you mean service?\n"


@pytest.mark.parametrize("words", ["topic pub /used std_msgs/msg/String", "topic echo /used std_msgs/msg/String"])
def test_another_type_than_the_notebooks_is_one_sentence(kernel: Kernel, words: str) -> None:
    assert kernel.run("from std_msgs.msg import Float64\nlab.publish('/used', Float64, data=1.0)").ok
    shown = kernel.run(f"%ros2 {words}")
    assert shown.stderr.startswith("/used has "), shown.stderr
    assert shown.ok


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("param set /faulty speed 2.5", "raised ValueError: too fast"),
        ("service call /fail std_srvs/srv/SetBool", "fail returned nothing. End it with `return response`."),
    ],
)
def test_a_callback_that_fails_is_told_to_the_command_that_waits_for_it(
    kernel: Kernel, words: str, wanted: str
) -> None:
    assert kernel.run(FAULTY).ok
    failed = kernel.run(f"%ros2 {words} --timeout 30")
    assert kernel.run("lab.stop('faulty')").ok
    told = [line for line in failed.stderr.splitlines() if line.startswith("faulty sent no response")]
    assert len(told) == 1, failed.stderr
    assert wanted in told[0]
    assert failed.ok
