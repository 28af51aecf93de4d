"""What a launch file does: conditions, groups, events, programs of any kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    Run = Callable[..., str]


@pytest.mark.parametrize(
    ("actions", "shown", "never"),
    [
        ("say('a', condition=None) if 0 else LogInfo(msg='yes', condition=IfCondition('True'))", "yes", ""),
        ("LogInfo(msg='no', condition=IfCondition('0')), say('end')", "end", "no\n"),
        ("LogInfo(msg='no', condition=UnlessCondition('true')), say('end')", "end", "no\n"),
        ("LogInfo(msg='unset', condition=LaunchConfigurationEquals('a', None))", "unset", ""),
        ("SetEnvironmentVariable('COLOUR', 'red'), say(EnvironmentVariable('COLOUR'))", "red", ""),
        ("say(EnvironmentVariable('NO_SUCH', default_value='plain'))", "plain", ""),
        ("say(PythonExpression(['1 + ', '2 * floor(2.5)']))", "]: 5\n", ""),
        ("say(PathJoinSubstitution(['a', 'b']))", "a/b", ""),
        ("say(Command(['echo ', 'from a program']))", "from a program", ""),
        ("say(FindExecutable(name='sh'))", "/sh\n", ""),
        (
            "OpaqueFunction(function=lambda context, word: [say(word)], args=['given '])",
            "given ",
            "",
        ),
        ("TimerAction(period='0.0', actions=[say('later')]), say('now')", "now\n[INFO] [launch.user]: later", ""),
    ],
)
def test_what_is_done_and_what_not(run: Run, actions: str, shown: str, never: str) -> None:
    done = run(actions)
    assert shown in done
    assert done.endswith("ended with 0")
    assert not never or never not in done


def test_a_group_ends_what_is_set_in_it(run: Run) -> None:
    done = run(
        "DeclareLaunchArgument('v', default_value='outer'), SetEnvironmentVariable('E', 'outer'),"
        "GroupAction([DeclareLaunchArgument('w', default_value='inner'), SetEnvironmentVariable('E', 'inner'),"
        " PushRosNamespace('fleet'), PushRosNamespace('one'), SetParameter('speed', 2.5),"
        " say('1 ', LaunchConfiguration('w'), ' ', EnvironmentVariable('E')),"
        " Node(executable='tell.py', namespace='arm', name='n', output='screen'),"
        " Node(executable='tell.py', namespace='/else', output='screen')]),"
        "say('2 ', LaunchConfiguration('w', default='outer'), ' ', EnvironmentVariable('E')),"
        "Node(executable='tell.py', output='screen')"
    )
    assert "1 inner inner" in done
    assert "2 outer outer" in done
    told = sorted(line.partition("told ")[2] for line in done.splitlines() if "told" in line)
    assert told == [
        "['--ros-args', '-r', '__node:=n', '-r', '__ns:=/fleet/one/arm', '-p', 'speed:=2.5']",
        "['--ros-args', '-r', '__ns:=/else', '-p', 'speed:=2.5']",
        "['--ros-args']",
    ]


def test_one_program_after_the_other(run: Run) -> None:
    """The chain that courses write: what starts when another has ended; a function decides."""
    done = run(
        "(first := ExecuteProcess(cmd=['sh', '-c', 'exit 3'])),"
        "RegisterEventHandler(OnProcessExit(target_action=first, on_exit="
        "lambda event, context: [say('ended with ', str(event.returncode)), (second)])),"
        "*[(second := ExecuteProcess(cmd=['echo', 'second'], output='screen'))][:0],"
        "RegisterEventHandler(OnProcessExit(target_action=second, on_exit=say('second is over')))"
    )
    order = [done.index(word) for word in ("ended with 3", "-2] second", "second is over")]
    assert order == sorted(order)
    assert done.endswith("ended with 0")


@pytest.mark.parametrize(
    "how",
    [
        "ExecuteProcess(cmd=['true'], on_exit=Shutdown(reason='enough'))",
        (
            "(p := ExecuteProcess(cmd=['true'])), RegisterEventHandler(OnProcessExit(target_action=p, "
            "on_exit=[EmitEvent(event=launch.events.Shutdown(reason='enough'))]))"
        ),
    ],
)
def test_one_program_ends_all(run: Run, how: str) -> None:
    done = run(f"ExecuteProcess(cmd=['sleep', '60']), {how}")
    assert "shutting down: enough" in done
    assert "[sleep-1]: sending signal 'SIGINT' to process[sleep-1]" in done
    assert done.endswith("ended with 0")


def test_a_program_is_started_again_after_its_end(run: Run) -> None:
    done = run(
        "ExecuteProcess(cmd=['sh', '-c', 'test -e once && exit 7; touch once'], respawn='true', respawn_delay=0.01),"
        "RegisterEventHandler(OnProcessExit("
        "on_exit=lambda event, context: [Shutdown(reason='twice')] if event.returncode == 7 else []))"
    )
    assert "[sh-2]: process has died" in done
    assert "[sh-3]" not in done


def test_an_included_file_gets_its_arguments_or_is_left_out(run: Run) -> None:
    run("DeclareLaunchArgument('who', default_value='nobody'), say('hello ', LaunchConfiguration('who'))", file="in.py")
    done = run(
        "IncludeLaunchDescription(PythonLaunchDescriptionSource(['in', '.py']), condition=IfCondition('false')),"
        "IncludeLaunchDescription('in.py', launch_arguments=[('who', 'you')])"
    )
    assert done.count("hello") == 1
    assert "hello you" in done
    assert "RecursionError" in run("IncludeLaunchDescription('it.launch.py')")


def test_a_launch_file_prints_a_line_of_its_own(run: Run) -> None:
    done = run(
        text="import launch.logging\n"
        "from launch import LaunchDescription\n"
        "def generate_launch_description():\n"
        "    launch.logging.get_logger('launch.user').info('version %d', 1)\n"
        "    return LaunchDescription([])\n"
    )
    assert done == "[INFO] [launch.user]: version 1\nended with 0"
