"""What is wrong with a launch file is a sentence with the file and the line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from .conftest import FIRST_LINE

if TYPE_CHECKING:
    from collections.abc import Callable

    Run = Callable[..., str]

HERE = f"it.launch.py, line {FIRST_LINE}: "


@pytest.mark.parametrize(
    ("actions", "sentence"),
    [
        ("Node(exectuable='tell.py')", "Node has no argument 'exectuable'. Did you mean executable?"),
        (
            "Node(package='a', executable='b', parametrs=[])",
            "Node has no argument 'parametrs'. Did you mean parameters?",
        ),
        ("DeclareLaunchArgument('a', defualt_value='1')", "'defualt_value'. Did you mean default_value?"),
        ("say(LaunchConfiguration('a', defalt='1'))", "'defalt'. Did you mean default?"),
        ("Node(package='a', node_executable='b')", "is from before ROS 2 Foxy: write executable=... instead."),
        ("ExecuteProcess(cmd=['true'], cached_output=True)", "ExecuteProcess(cached_output=...) is not part of"),
        ("Node(executable='tell.py', parameters={'a': 1})", "Node(parameters=...) is a list: write [ and ] around"),
        ("say(LaunchConfiguration('sped'))", "LaunchConfiguration('sped') has no value: no DeclareLaunchArgument"),
        ("Node(executable='tell.py', output='loud')", "output='loud': the course kit knows screen"),
        ("LogInfo(msg='a', condition=IfCondition('maybe'))", "A condition is true or false, and 'maybe' is neither."),
        ("say(EnvironmentVariable('NO_SUCH'))", "The environment variable NO_SUCH is not set"),
        ("say(PythonExpression('1 +'))", "PythonExpression('1 +'): SyntaxError"),
        ("say(Command('false'))", "Command('false') failed with exit code 1."),
        ("say(Command('no_such_program a'))", "Command('no_such_program a') cannot be run: No such file"),
        ("say(FindPackageShare('no_such'))", "Package 'no_such' not found."),
        ("say(FindExecutable(name='no_such'))", "There is no program no_such on PATH."),
        ("OpaqueFunction(function=lambda context: 1 / 0)", "ZeroDivisionError: division by zero"),
        ("RegisterEventHandler(OnProcessExit(target_action='talker', on_exit=[]))", "a Node or ExecuteProcess is"),
        ("__import__('ament_index_python').get_package_share_directory('no_such')", "Package 'no_such' not found."),
        ("IncludeLaunchDescription('robot.launch.xml')", "robot.launch.xml is a launch file in XML. The course reads"),
        (
            "IncludeLaunchDescription('robot.launch.yaml')",
            "robot.launch.yaml is a launch file in YAML.",
        ),
        ("launch_ros.actions.ComposableNodeContainer", "components and lifecycle nodes are what systems of compiled"),
        ("launch_ros.actions.LifecycleNode", "launch_ros.actions.LifecycleNode is not part of the course kit's"),
        ("launch.actions.ResetEnvironment", "launch.actions.ResetEnvironment is not part of the course kit's"),
    ],
)
def test_the_sentence_names_file_and_line(run: Run, actions: str, sentence: str) -> None:
    done = run(actions)
    assert "Traceback" not in done
    assert f"failed: {HERE}" in done
    assert sentence in done


def test_a_program_that_is_missing_does_not_end_the_rest(run: Run) -> None:
    done = run(
        "Node(package='rviz2', executable='rviz2'),"
        "Node(package='nowhere', executable='talker'),"
        "ExecuteProcess(cmd=['no_such_program']),"
        "Node(executable='tell.py', output='screen')"
    )
    assert f"[ERROR] [launch]: {HERE}Package 'rviz2' not found: it comes with a full ROS 2 installation" in done
    assert f"[ERROR] [launch]: {HERE}Package 'nowhere' not found, nor a script talker.py in" in done
    assert f"[ERROR] [launch]: {HERE}no_such_program cannot be started: No such file or directory." in done
    assert "told ['--ros-args']" in done
    assert done.endswith("ended with 1")


def test_a_misspelt_value_of_an_argument_is_told_and_one_that_is_spelt_right_is_not(run: Run) -> None:
    declared = "DeclareLaunchArgument('speed', default_value='1'), say(LaunchConfiguration('speed'))"
    assert "No launch file declares the argument 'sped'. Did you mean speed?" in run(declared, sped="2")
    assert "Did you mean" not in run(declared, speed="2", something_else="3")
    assert "]: 2\n" in run(declared, speed="2")
