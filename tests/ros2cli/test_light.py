"""A command is quick because it imports little, and leaves the graph before it ends."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .commands import Ros2


def test_a_listing_imports_neither_numpy_nor_the_generator_of_messages(robot: Ros2) -> None:
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "course_kit.ros2cli", "service", "list", "--no-daemon"],
        env=robot.environ,
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    imported = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "/set_power" in done.stdout.split()
    assert "rclpy" in imported
    assert not imported & {"numpy", "lark", "rosidl_parser.parser", "rclpy.action"}


def test_nothing_of_a_command_is_left_on_the_graph(robot: Ros2) -> None:
    called = robot("service", "call", "/set_power", "std_srvs/srv/SetBool", "{data: true}")
    assert (called.returncode, "success=True" in called.stdout) == (0, True)
    left = robot("node", "list", "--all", "--no-daemon").stdout.split()
    assert [name for name in left if "_ros2cli_daemon" not in name] == ["/robot"]
    assert "Clients count: 0" in robot("service", "info", "/set_power", "--no-daemon").stdout
