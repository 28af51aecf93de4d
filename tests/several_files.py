"""A small exercise of several programs, a launch file and a parameter file, and a right answer to it."""

from __future__ import annotations

import json
import zipfile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

ID = "gate_and_guard"
PARTS = ("gate", "guard", "pair")
_TOML = """
format_version = 1
id = "gate_and_guard"
title = "A gate and its guard"
order = 8
points = 5.0
pass_mark = 2.0
files = ["gate.py", "guard.py", "pair.launch.py", "pair.yaml"]
parts = ["gate", "guard", "pair"]
notebook = "gate_and_guard.ipynb"
grader = "checks.py"
solution = "solution"

[limits]
wall_s = 60.0

[[endpoints]]
program = "gate.py"
kind = "service"
name = "/gate/open"
type = "std_srvs/srv/SetBool"

[[endpoints]]
program = "guard.py"
kind = "publisher"
name = "/guard/pace"
type = "std_msgs/msg/Float64"
"""
_CHECKS = '''
from std_srvs.srv import SetBool

from course_kit.grading.checks.vocabulary import check


@check(points=2.0)
def gate(node):
    """The gate opens."""
    node.start(program="gate.py", parameters={"reason": "bolted"})
    node.call("/gate/open", data=True).expect(success=True, message="bolted")


@check(points=1.0, begin=lambda node: node.start(program="guard.py"))
def guard(node):
    """The guard walks."""
    node.expect("/guard/pace", 1.0)


@check(points=2.0)
def pair(node):
    """Both run together."""
    node.start("pace:=3.5", program="pair.launch.py")
    node.parameters("/guard").expect_served()
    node.call("/gate/open", data=True).expect(success=True, message="from the file")
    node.expect("/guard/pace", 3.5)
    node.kill("gate.py")
    asked = node.context.grader_node.client(SetBool, "/gate/open").send(SetBool.Request(data=True))
    assert not node.context.wait_until(asked.is_answered, 0.2)
    assert (node.context.program.asked, node.context.record.partner) == ("guard.py", "guard")
    node.expect("/guard/pace", 3.5)


CHECKS = [gate, guard, pair]
'''
FILES = {
    "gate.py": """
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Gate(Node):
    def __init__(self):
        super().__init__("gate")
        self.declare_parameter("reason", "free")
        self.create_service(SetBool, "/gate/open", self.move)

    def move(self, request, response):
        response.success = request.data
        response.message = self.get_parameter("reason").value
        return response


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Gate())
""",
    "guard.py": """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Guard(Node):
    def __init__(self):
        super().__init__("guard")
        self.declare_parameter("pace", 1.0)
        self.out = self.create_publisher(Float64, "/guard/pace", 10)
        self.create_timer(0.05, self.step)

    def step(self):
        self.out.publish(Float64(data=self.get_parameter("pace").value))


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Guard())
""",
    "pair.launch.py": """
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

HERE = Path(__file__).parent


def generate_launch_description():
    settings = str(HERE / "pair.yaml")
    pace = {"pace": LaunchConfiguration("pace")}
    return LaunchDescription([
        DeclareLaunchArgument("pace", default_value="2.0"),
        Node(executable=str(HERE / "gate.py"), parameters=[settings]),
        Node(executable=str(HERE / "guard.py"), parameters=[settings, pace]),
    ])
""",
    "pair.yaml": """
gate:
  ros__parameters:
    reason: from the file
""",
}


def write_files(folder: Path, **changed: str | None) -> Path:
    """A right answer, some of its files by another text, or left out for None; `gate_py` stands for gate.py."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, right in FILES.items():
        text = changed.get(name.replace(".", "_"), right)
        if text is not None:
            (folder / name).write_text(text)
    return folder


def write(place: Path) -> Path:
    """The exercise, in a folder within this one."""
    made = place / ID
    write_files(made)
    write_files(made / "solution")
    (made / "exercise.toml").write_text(_TOML)
    (made / "checks.py").write_text(_CHECKS)
    return made


def notebook(**changed: str | None) -> str:
    """The same as a notebook: a cell for each file."""
    texts = {name: changed.get(name.replace(".", "_"), text) for name, text in FILES.items()}
    cells = [
        {"cell_type": "code", "source": f"%%submission {ID} {name}\n{text}"} for name, text in texts.items() if text
    ]
    return json.dumps({"cells": cells})


def zipped(place: Path, **changed: str | None) -> Path:
    """The same as a zip archive, within a folder, as file managers pack it."""
    with zipfile.ZipFile(place, "w") as archive:
        for path in write_files(place.with_suffix(""), **changed).iterdir():
            archive.write(path, f"{place.stem}/{path.name}")
    return place
