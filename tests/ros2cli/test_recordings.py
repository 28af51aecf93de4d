"""Every recorded sample of the real command against ours."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment

from . import recordings
from .commands import GOLDEN, OURS, Ros2, interrupt, lines_until

if TYPE_CHECKING:
    from collections.abc import Iterator

# Where ours differs on purpose: errors are one line with the nearest right name, and children get one SIGINT.
ANNOUNCED = {
    "action_send_goal_unknown_type": "the error names the nearest right type",
    "launch_package_ok": "a child gets one SIGINT instead of two, so it ends cleanly",
    "param_get_unknown": "the error names the parameter",
    "param_set_unknown_node": "the error names the node",
    "service_call_bad_yaml": "one line instead of a traceback",
    "service_call_unknown_type": "the error names the nearest right type",
}
# In this order: some change what others show. The recordings were made one after another, too.
SETTING = [
    "param_get_max_velocity",
    "param_get_robot_name",
    "param_get_unknown",
    "param_set_good",
    "param_set_out_of_range",
    "param_set_unknown_node",
    "param_load",
    "param_dump",
]
LAUNCHES = ["launch_exe_path", "launch_package_ok"]
INTERRUPTED = ["pr956_action_send_goal_feedback_ctrl_c"]
PAIR = [name for name in recordings.all_names() if name.startswith("B_")]
EMPTY = ["empty_graph_service_list"]
ASKING = [name for name in recordings.all_names() if name not in [*SETTING, *LAUNCHES, *INTERRUPTED, *PAIR, *EMPTY]]
LAUNCH_FILE = """
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([Node({which}, output='screen', {more})])
"""


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros2]:
    """The command, where the add server and the Fibonacci server run."""
    with environment.exclusive_domain() as domain, Ros2(domain, tmp_path_factory.mktemp("pair")) as command:
        command.start(GOLDEN / "add_server.py", "/add_two_ints_server")
        command.start(GOLDEN / "fib_server_ei.py", "/fibonacci_action_server")
        yield command


def compare(name: str, exit_code: int, stdout: str, stderr: str) -> None:
    real = recordings.read(name)
    printed, recorded = recordings.normal(stdout), recordings.normal(real.stdout)
    assert exit_code == real.exit_code
    if name not in ANNOUNCED:
        assert (printed, stderr) == (recorded, real.stderr)
        return
    assert (printed, stderr) != (recorded, real.stderr), "there is no difference any more: take it out of ANNOUNCED"
    if name in LAUNCHES:
        assert printed == cleanly_ended(recorded)
        return
    assert printed == recorded
    assert len(stderr.splitlines()) == 1
    assert "Traceback" not in stderr
    if "Traceback" not in real.stderr:
        assert stderr.startswith(real.stderr.strip())


def cleanly_ended(recorded: str) -> str:
    *lines, last = recorded.splitlines()
    assert "process has died" in last
    return "\n".join([*lines, "[INFO] [robot_node-1]: process has finished cleanly [pid <pid>]", ""])


def run_and_compare(name: str, command: Ros2) -> None:
    words = [word.replace("DEMO", str(command.folder)) for word in recordings.read(name).words]
    done = command.process(*words) if name in PAIR else command(*words)
    compare(name, done.returncode, done.stdout, done.stderr)


@pytest.mark.parametrize("name", EMPTY)
def test_on_an_empty_graph(name: str, ros2: Ros2) -> None:
    run_and_compare(name, ros2)


@pytest.mark.parametrize("name", ASKING)
def test_what_changes_nothing(name: str, robot: Ros2) -> None:
    run_and_compare(name, robot)


@pytest.mark.parametrize("name", PAIR)
def test_with_the_tutorial_servers(name: str, pair: Ros2) -> None:
    run_and_compare(name, pair)


@pytest.mark.parametrize("name", INTERRUPTED)
def test_ctrl_c_cancels_the_goal(name: str, robot: Ros2) -> None:
    sending = robot.begin(*OURS, *recordings.read(name).words)
    before = "".join([*lines_until(sending, "Feedback:"), *lines_until(sending, "- 3")])
    after, stderr = interrupt(sending)
    compare(name, sending.returncode, before + after, stderr)


@pytest.mark.parametrize("name", SETTING)
def test_parameters_one_after_another(name: str, robot: Ros2) -> None:
    (robot.folder / "_load.yaml").write_text(
        "/robot:\n  ros__parameters:\n    max_velocity: 2.5\n    robot_name: r2d2\n"
    )
    run_and_compare(name, robot)


@pytest.mark.parametrize("name", LAUNCHES)
def test_launch_until_ctrl_c(name: str, ros2: Ros2) -> None:
    # Ctrl-C can leave a MultiThreadedExecutor's pool locked, and Python then waits for its threads for ever.
    program = (GOLDEN / "demo_node.py").read_text()
    program = program.replace("MultiThreadedExecutor(4)", "rclpy.executors.SingleThreadedExecutor()")
    if name == "launch_exe_path":
        script = ros2.folder / "robot_node.py"
        which, more = f"executable={str(script)!r}", "parameters=[{'robot_name': 'r2d2', 'max_velocity': 2.5}]"
    else:
        script = ros2.folder / "lib" / "course_robot" / "robot_node"
        script.parent.mkdir(parents=True)
        which = "package='course_robot', executable='robot_node', name='robot'"
        more = "parameters=[{'robot_name': 'r2d2', 'max_velocity': 2.5, 'wheel_diameter': 0.2}]"
        ros2.environ["AMENT_PREFIX_PATH"] = str(ros2.folder)
    # As pip writes it: a "#!" line cannot name a Python in a folder with a space.
    script.write_text(f"#!/bin/sh\n'''exec' \"{sys.executable}\" \"$0\" \"$@\"\n' '''\n{program}")
    script.chmod(0o755)
    file = ros2.folder / recordings.read(name).words[1]
    file.write_text(LAUNCH_FILE.format(which=which, more=more))
    launch = ros2.begin(*OURS, "launch", file.name)
    before = "".join(lines_until(launch, "ready:"))
    assert "hello" in ros2("topic", "echo", "--once", "/chatter").stdout  # the node spins
    after, stderr = interrupt(launch)
    compare(name, launch.returncode, before + after, stderr)


def test_every_recording_is_compared() -> None:
    assert sorted([*SETTING, *LAUNCHES, *INTERRUPTED, *PAIR, *EMPTY, *ASKING]) == recordings.all_names()
    assert set(ANNOUNCED) <= set(recordings.all_names())
