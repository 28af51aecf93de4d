"""`%%ros_launch`: a launch file in the background of a lab."""

from __future__ import annotations

from typing import TYPE_CHECKING

import psutil
import pytest

from course_kit import lab
from course_kit.integrations.magics import MagicError, ros_launch, ros_script, ros_stop
from tests.waiting import wait_until

from .commands import PROGRAMS, is_alive

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.lab.runtime.core import Lab

LAUNCH = (PROGRAMS / "parameter_node.launch.py").read_text()
ARGUMENT = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration

def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument("who"), LogInfo(msg=["hello ", LaunchConfiguration("who")])])
"""


@pytest.fixture(autouse=True)
def folder_of_the_lessons(own_lab: Lab, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lab's folder of scripts has the lessons' node."""
    assert own_lab
    (tmp_path / "scripts").mkdir()
    monkeypatch.setattr("course_kit.environment.run_dir", tmp_path.joinpath)
    monkeypatch.setenv("COURSE_KIT_PACKAGE_PATH", str(PROGRAMS))


def test_the_lessons_launch_file_runs_in_the_background_until_it_is_stopped(
    own_lab: Lab, capfd: pytest.CaptureFixture[str]
) -> None:
    own_lab.record()
    ros_launch("parameter_node", LAUNCH)
    shown = capfd.readouterr().out.splitlines()
    assert shown[0].startswith("[INFO] [parameter_node-1]: process started with pid [")
    assert shown[1:] == [
        "[parameter_node-1] [INFO] [parameter_node]: Robot: turtlebot4",
        "[parameter_node-1] [INFO] [parameter_node]: Max velocity: 2.0",
        "[parameter_node-1] [INFO] [parameter_node]: Wheel diameter: 0.15",
        "parameter_node.launch is running in the background (node parameter_node).",
    ]
    children = psutil.Process(own_lab.scripts._running["parameter_node.launch"].process.pid).children()
    assert len(children) == 1
    assert lab.get_parameters_blocking("/parameter_node", "max_velocity") == {"max_velocity": 2.0}
    assert "parameter_node -> lab" in str(lab.diagram())  # what its nodes exchange is recorded
    ros_stop("parameter_node.launch")
    assert capfd.readouterr().out == "parameter_node.launch is stopped.\n"
    wait_until(lambda: not is_alive(children[0].pid), "the end of the node")


def test_arguments_reach_the_launch_file(capfd: pytest.CaptureFixture[str]) -> None:
    ros_launch("hello who:=you", ARGUMENT)
    assert "hello you" in capfd.readouterr().out


@pytest.mark.parametrize(
    ("line", "text", "expected"),
    [
        ("broken", "1 / 0", "broken.launch.py, line 1: ZeroDivisionError: division by zero"),
        ("hello you", ARGUMENT, "'you' is not a launch argument: write you:=value."),
        ("hello who=you", ARGUMENT, "'who=you' is not a launch argument: write who:=you."),
        ("robot", LAUNCH.replace("'parameter_node'", "'parameter_nod'"), "nor a script parameter_nod.py"),
    ],
)
def test_what_is_wrong_with_it_is_one_line(
    line: str, text: str, expected: str, capfd: pytest.CaptureFixture[str]
) -> None:
    ros_launch(line, text)
    shown = capfd.readouterr().out
    assert expected in shown
    assert "Traceback" not in shown


def test_a_saved_program_runs_again_with_other_arguments(capfd: pytest.CaptureFixture[str]) -> None:
    ros_script("tell one", "import sys\nprint('told', sys.argv[1:])\n")
    ros_script("tell two three")
    assert capfd.readouterr().out == "told ['one']\ntold ['two', 'three']\n"
    with pytest.raises(MagicError, match=r"'tel': run its cell first\. Saved: .*tell"):
        ros_script("tel two")
