"""Launch files: what they start, what it says, and that all of it ends."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from tests.waiting import wait_until

from .commands import OURS, Ros2, interrupt, is_alive, lines_until

if TYPE_CHECKING:
    from pathlib import Path

HEAD = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, LogInfo, TimerAction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([{actions}])
"""
TELL = """
import sys
print(sys.argv[1:])
for word, value in zip(sys.argv, sys.argv[1:]):
    if word == '--params-file':
        print(open(value).read())
"""
STUBBORN = """
import os, signal, subprocess, sys, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(600)'])
print('pids', os.getpid(), child.pid, flush=True)
time.sleep(600)
"""


def write(folder: Path, actions: str, name: str = "it.launch.py") -> str:
    (folder / name).write_text(HEAD.format(actions=actions))
    return name


@pytest.fixture
def tell(ros2: Ros2) -> Ros2:
    """The command, in a folder with a package `my_package` and its program `tell`."""
    (ros2.folder / "my_package").mkdir()
    (ros2.folder / "my_package" / "tell.py").write_text(TELL)
    return ros2


def test_everything_about_a_node_reaches_the_program(tell: Ros2) -> None:
    (tell.folder / "more.yaml").write_text("{}")
    file = write(
        tell.folder,
        "Node(package='my_package', executable='tell', name='n', namespace='ns', output='screen', arguments=['one'],"
        "parameters=[{'speed': 2.0, 'names': ['a', 'b'], 'on': True}, 'more.yaml'], remappings=[('in', '/out')])",
    )
    done = tell.process("launch", file)
    arguments = next(line for line in done.stdout.splitlines() if "--ros-args" in line)
    assert "'one', '--ros-args', '-r', '__node:=n', '-r', '__ns:=/ns', '--params-file'" in arguments
    assert "more.yaml', '-r', 'in:=/out'" in arguments
    assert "[tell-1]     names:\n[tell-1]     - a\n[tell-1]     - b\n[tell-1]     'on': true\n" in done.stdout
    assert "[tell-1]: process has finished cleanly" in done.stdout
    assert done.returncode == 0


def test_arguments_includes_and_timers(tell: Ros2) -> None:
    write(
        tell.folder, "DeclareLaunchArgument('who'), LogInfo(msg=['hello ', LaunchConfiguration('who')])", "in.launch.py"
    )
    file = write(
        tell.folder,
        "DeclareLaunchArgument('speed', default_value='1.5', description='in m/s'),"
        "TimerAction(period=0.3, actions=[LogInfo(msg='late')]),"
        "IncludeLaunchDescription(PythonLaunchDescriptionSource(PathJoinSubstitution(['.', "
        "'in.launch.py'])), launch_arguments={'who': 'me'}.items()),"
        "Node(package='my_package', executable='tell', output='screen',"
        " parameters=[{'speed': LaunchConfiguration('speed')}])",
    )
    done = tell.process("launch", file, "speed:=7.5")
    assert "speed: 7.5" in done.stdout
    assert done.stdout.index("hello me") < done.stdout.index("process started") < done.stdout.index("late")
    shown = tell("launch", "--show-args", file).stdout
    assert "    'speed':\n        in m/s\n        (default: '1.5')\n" in shown
    assert "    'who':\n        no description given\n" in shown


def test_a_folder_called_launch_is_no_package(tell: Ros2) -> None:
    """Every ROS package has one, and `python -m` has the current folder on its path."""
    (tell.folder / "launch").mkdir()
    file = write(tell.folder / "launch", "LogInfo(msg='found')")
    assert "found" in tell.process("launch", f"launch/{file}").stdout


def test_children_that_ignore_everything_are_killed_and_so_are_theirs(ros2: Ros2) -> None:
    (ros2.folder / "stubborn.py").write_text(STUBBORN)
    file = write(ros2.folder, "Node(package='here', executable='stubborn', output='screen')")
    code = (
        "from course_kit.launch import service; service.PATIENCE_S = (0.3, 0.3, 0.3); "
        f"from course_kit.ros2cli.cli import run_command; run_command(['launch', {file!r}])"
    )
    launch = ros2.begin(sys.executable, "-c", code)
    pids = [int(word) for word in lines_until(launch, "pids")[-1].split()[-2:]]
    said, _ = interrupt(launch)
    steps = [said.index(f"sending signal '{name}'") for name in ("SIGINT", "SIGTERM", "SIGKILL")]
    assert steps == sorted(steps)
    assert "exit code -9" in said
    wait_until(lambda: not any(is_alive(pid) for pid in pids), "the end of both")


def test_a_child_does_not_survive_a_launch_that_is_killed(ros2: Ros2) -> None:
    (ros2.folder / "stubborn.py").write_text(STUBBORN)
    file = write(ros2.folder, "Node(package='here', executable='stubborn', output='screen')")
    launch = ros2.begin(*OURS, "launch", file)
    child, grandchild = map(int, lines_until(launch, "pids")[-1].split()[-2:])
    launch.send_signal(signal.SIGKILL)
    wait_until(lambda: not is_alive(child), "the end of the child")
    os.kill(grandchild, signal.SIGKILL)  # nobody else ends it: what a program starts is its own affair


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("from launch.actions import PopEnvironment", "launch.actions.PopEnvironment is not part of the course kit's"),
        ("import launch.frontend", "launch.frontend is not part of the course kit's"),
        ("from launch_ros.descriptions import ComposableNode", "components and lifecycle nodes are what systems of"),
        ("x = = 1", "bad.launch.py, line 1: SyntaxError"),
        ("x = 1", "no function generate_launch_description()"),
    ],
)
def test_a_file_outside_the_subset(ros2: Ros2, text: str, wanted: str) -> None:
    (ros2.folder / "bad.launch.py").write_text(text)
    done = ros2("launch", "bad.launch.py")
    assert wanted in done.stderr
    assert done.returncode == 1


def test_real_packages_win(tmp_path: Path) -> None:
    for name in ("launch", "launch_ros"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("stand_in = 'for the real one, named as a stand-in'")
    code = "import launch, launch_ros; print(launch.stand_in, launch_ros.stand_in)"
    command = [sys.executable, "-c", code]
    assert "stand-in" in subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    ours = subprocess.run(
        [sys.executable, "-c", "import launch.actions; print(launch.actions.__all__)"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "TimerAction" in ours.stdout


def test_a_program_by_its_entry_point(ros2: Ros2) -> None:
    done = ros2.process("run", "pytest", "pytest", "--version")
    assert "pytest" in done.stdout + done.stderr
    assert done.returncode == 0
