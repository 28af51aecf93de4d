"""Tab completion, stepping aside for a real command, and `%ros2` in a kernel's own context."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from .commands import Ros2

COMPLETE = "from course_kit.ros2cli.cli import main; main()"
STAND_IN = """#!/bin/sh
# A stand-in for a real ros2, for this test.
echo "stand-in for the real ros2: $@"
env | grep -E '^(_ROS_WHEELS|LD_LIBRARY_PATH|PYTHONPATH|ROS_DOMAIN_ID)=' | sort
exit 7
"""
MAGIC = """
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool
from course_kit import lab
from course_kit.ros2cli.cli import ros2_line

class Server(Node):
    def __init__(self):
        super().__init__('server')
        self.create_service(SetBool, 'set_power', self.answer)
    def answer(self, request, response):
        response.success = request.data
        return response

lab.start(Server)
for line in {lines!r}:
    print('>', line, flush=True)
    ros2_line(line)
lab.stop()
"""


def completions(ros2: Ros2, line: str) -> list[str]:
    """What a shell is offered at the end of `line`; argcomplete's protocol, the answer on descriptor 8."""
    out = ros2.folder / "completions"
    environ = {"_ARGCOMPLETE": "1", "_ARGCOMPLETE_IFS": "\n", "COMP_LINE": line, "COMP_POINT": str(len(line))}
    environ |= {"_ARGCOMPLETE_STDOUT_FILENAME": str(out), "COMP_TYPE": "9"}
    subprocess.run(
        [sys.executable, "-c", COMPLETE], env={**ros2.environ, **environ}, check=True, timeout=60, capture_output=True
    )
    return [word.strip() for word in out.read_text().split("\n")]


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("ros2 ser", ["service"]),
        ("ros2 service call /set", ["/set_power"]),
        ("ros2 param get /robot max", ["max_velocity"]),
        ("ros2 interface show geometry_msgs/msg/Twist", ["geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"]),
        ("ros2 service list --show", ["--show-types"]),
    ],
)
def test_tab(robot: Ros2, line: str, wanted: list[str]) -> None:
    found = completions(robot, line)
    assert found[: len(wanted)] == wanted


def run_script(ros2: Ros2, path: str, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the command as its installed script does."""
    environ = {**ros2.environ, "PATH": path, "LD_LIBRARY_PATH": f"{sys.prefix}/lib:/opt/their/lib"}
    code = f"import sys; sys.argv = ['ros2', *{list(words)!r}]; {COMPLETE}"
    return subprocess.run(
        [sys.executable, "-c", code], env=environ, capture_output=True, text=True, timeout=60, check=False
    )


def test_a_real_command_is_run_instead_in_a_clean_environment(ros2: Ros2, tmp_path: Path) -> None:
    folder = tmp_path / "stand_in"
    folder.mkdir()
    (folder / "ros2").write_text(STAND_IN)
    (folder / "ros2").chmod(0o755)
    done = run_script(ros2, f"{tmp_path}:{folder}:{os.environ['PATH']}", "service", "list", "--whatever")
    first, *variables = done.stdout.splitlines()
    assert first == "stand-in for the real ros2: service list --whatever"
    assert f"ROS_DOMAIN_ID={ros2.environ['ROS_DOMAIN_ID']}" in variables
    assert "LD_LIBRARY_PATH=/opt/their/lib" in variables
    assert not any(name.startswith("_ROS_WHEELS") for name in variables)
    assert done.returncode == 7


def test_another_script_of_the_course_kit_is_no_real_command(ros2: Ros2, tmp_path: Path) -> None:
    (tmp_path / "ros2").write_text("#!/usr/bin/env python3\nfrom course_kit.ros2cli.cli import main\nmain()\n")
    (tmp_path / "ros2").chmod(0o755)
    done = run_script(ros2, str(tmp_path), "service", "list")
    assert (done.stdout, done.stderr, done.returncode) == ("", "", 0)


def test_in_a_kernel_the_nodes_of_the_kernel_are_there_at_once(ros2: Ros2) -> None:
    lines = [
        "service list",
        "service list -c",
        "node list -a",
        "service call /set_power std_srvs/srv/SetBool '{data: true}'",
        "param list /server",
        "service list -c",
        "service type /set_powr",
        "service list 'unfinished",
        "run nowhere nothing",
        "run here hello",
    ]
    (ros2.folder / "hello.py").write_text("print('hello from', __name__)")
    kernel = ros2.begin(sys.executable, "-c", MAGIC.format(lines=lines))
    stdout, stderr = kernel.communicate(timeout=60)
    assert "/set_power" in stdout
    assert "SetBool_Response(success=True, message='')" in stdout
    assert "  use_sim_time" in stdout
    first, again = (part.split("\n")[1] for part in stdout.split("> service list -c")[1:])
    assert int(first) == int(again) > 0  # the command's own nodes have left nothing
    assert "Did you mean /set_power?" in stderr
    assert "No closing quotation" in stderr
    assert "Package 'nowhere' not found" in stderr
    assert "hello from __main__" in stdout
    assert "Traceback" not in stderr
    assert "daemon" not in stdout
    assert kernel.returncode == 0
