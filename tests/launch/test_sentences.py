"""What is wrong with a launch file is a sentence with the file and the line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.ros2cli import cli

from .conftest import FIRST_LINE, HEAD

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    Run = Callable[..., str]

HERE = f"it.launch.py, line {FIRST_LINE}: "


@pytest.mark.parametrize(
    ("actions", "sentence"),
    [
        (
            "Node(exectuable='tell.py')",
            "Node has no argument 'exectuable' in the course kit's launch files. Did you mean executable?",
        ),
        ("ExecuteProcess(cmd=['true'], prefix='time')", "ExecuteProcess has no argument 'prefix' in the course kit's"),
        ("Node(executable='tell.py', parameters={'a': 1})", "Node(parameters=...) is a list: write [ and ] around"),
        ("say(LaunchConfiguration('sped'))", "LaunchConfiguration('sped') has no value: no DeclareLaunchArgument"),
        ("Node(executable='tell.py', output='loud')", "output='loud': the course kit knows screen"),
        ("LogInfo(msg='a', condition=IfCondition('maybe'))", "A condition is true or false, and 'maybe' is neither."),
        ("say(PythonExpression('1 +'))", "PythonExpression('1 +'): SyntaxError"),
        ("say(Command('false'))", "Command('false') failed with exit code 1."),
        ("say(Command('no_such_program a'))", "Command('no_such_program a') cannot be run: No such file"),
        ("say(FindPackageShare('no_such'))", "Package 'no_such' not found."),
        ("OpaqueFunction(function=lambda context: 1 / 0)", "ZeroDivisionError: division by zero"),
        ("RegisterEventHandler(OnProcessExit(target_action='talker', on_exit=[]))", "expected a Node or an"),
        ("IncludeLaunchDescription('robot.launch.xml')", "robot.launch.xml is a launch file in XML. The course reads"),
        ("launch_ros.actions.ComposableNodeContainer", "components and lifecycle nodes are what systems of compiled"),
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


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["speed=3"], "'speed=3' is not a launch argument: write speed:=3."),
        (["fast"], "'fast' is not a launch argument: write fast:=value."),
    ],
)
def test_a_word_that_is_no_argument(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str], sentence: str
) -> None:
    (folder / "it.launch.py").write_text(HEAD.replace("{actions}", ""))
    assert cli.run_command(["launch", "it.launch.py", *words]) == 1
    assert capsys.readouterr().err == f"{sentence}\n"


def test_the_arguments_are_shown_once_as_they_are_declared_first(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    argument = "DeclareLaunchArgument('{}', default_value='{}', description='{}')"
    (folder / "in.launch.py").write_text(HEAD.replace("{actions}", argument.format("inner", "2", "of the inner one")))
    actions = (
        argument.format("speed", "1", "first"),
        "IncludeLaunchDescription('in.launch.py'), IncludeLaunchDescription('in.launch.py')",
        "IncludeLaunchDescription(LaunchConfiguration('not_yet_known'))",
        f"GroupAction([{argument.format('speed', '2', 'second')}, {argument.format('deep', '3', 'in a group')}])",
        f"RegisterEventHandler(OnProcessExit(on_exit=[{argument.format('late', '4', 'for the end')}]))",
    )
    (folder / "it.launch.py").write_text(HEAD.replace("{actions}", ",\n".join(actions)))
    assert cli.run_command(["launch", "--show-args", "it.launch.py"]) == 0
    shown = capsys.readouterr().out
    entries = ("speed", "first", "1"), ("inner", "of the inner one", "2"), ("deep", "in a group", "3")
    told = [
        f"    '{a}':\n        {b}\n        (default: '{c}')" for a, b, c in (*entries, ("late", "for the end", "4"))
    ]
    assert shown.partition("\n\n")[2] == "\n\n".join(told) + "\n"


@pytest.mark.parametrize("words", [["robot.launch.xml"], ["arm", "robot.launch.xml"], ["arm", "robot.yaml"]])
def test_a_launch_file_in_another_language_is_named_for_what_it_is(
    folder: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    (folder / "arm" / "launch").mkdir(parents=True)
    for place in ("robot.launch.xml", "arm/launch/robot.launch.xml", "arm/launch/robot.yaml"):
        (folder / place).write_text("<launch/>")
    assert cli.run_command(["launch", *words]) == 1
    kind = "XML" if words[-1].endswith("xml") else "YAML"
    assert (
        f"{words[-1]} is a launch file in {kind}. The course reads launch files in Python only"
        in capsys.readouterr().err
    )
