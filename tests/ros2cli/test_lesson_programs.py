"""The commands that lessons show, one by one, against the lessons' own programs."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment

from .commands import OURS, PROGRAMS, Ros2, interrupt, lines_until

if TYPE_CHECKING:
    from collections.abc import Iterator

FIBONACCI = ("action", "send_goal", "/fibonacci", "example_interfaces/action/Fibonacci", "{order: 5}")


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros2]:
    """The command, where the lessons' three servers run."""
    folder = tmp_path_factory.mktemp("lesson")
    with environment.exclusive_domain() as domain, Ros2(domain, folder) as command:
        command.start(PROGRAMS / "minimal_service.py", "/minimal_service")
        command.start(PROGRAMS / "fibonacci_action_server.py", "/fibonacci_action_server")
        command.start(PROGRAMS / "parameter_node.py", "/parameter_node")
        yield command


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (("service", "list"), "/add_two_ints\n"),
        (("service", "info", "/add_two_ints"), "Type: example_interfaces/srv/AddTwoInts\nClients count: 0\nServices"),
        (
            ("service", "call", "/add_two_ints", "example_interfaces/srv/AddTwoInts", "{a: 1, b: 2}"),
            "response:\nexample_interfaces.srv.AddTwoInts_Response(sum=3)\n",
        ),
        (("action", "list"), "/fibonacci\n"),
        (("action", "info", "/fibonacci"), "Action servers: 1\n    /fibonacci_action_server\n"),
        (FIBONACCI, "Result:\n    sequence:\n- 0\n- 1\n- 1\n- 2\n- 3\n- 5\n\nGoal finished with status: SUCCEEDED\n"),
        (("param", "list", "/parameter_node"), "  max_velocity\n  robot_name\n"),
        (("param", "get", "/parameter_node", "robot_name"), "String value is: default_robot\n"),
        (("param", "set", "/parameter_node", "robot_name", "turtlebot4"), "Set parameter successful\n"),
        (("param", "get", "/parameter_node", "robot_name"), "String value is: turtlebot4\n"),
    ],
    ids=lambda value: " ".join(value[:2]) if isinstance(value, tuple) else "",
)
def test_command_of_a_lesson(lesson: Ros2, words: tuple[str, ...], wanted: str) -> None:
    done = lesson(*words)
    assert wanted in done.stdout
    assert (done.returncode, done.stderr) == (0, "")


def test_the_lessons_client_beside_the_command(lesson: Ros2) -> None:
    client = lesson.begin(sys.executable, str(PROGRAMS / "minimal_client.py"), "2", "3")
    _, stderr = client.communicate(timeout=60)
    assert "Result of add_two_ints: 5" in stderr


def test_the_lessons_launch_file(ros2: Ros2) -> None:
    launch = ros2.begin(*OURS, "launch", str(PROGRAMS / "parameter_node.launch.py"))
    shown = "".join(lines_until(launch, "Wheel diameter"))
    assert "[parameter_node-1]: process started" in shown
    assert ros2("param", "get", "/parameter_node", "robot_name").stdout == "String value is: turtlebot4\n"
    assert ros2("param", "get", "/parameter_node", "max_velocity").stdout == "Double value is: 2.0\n"
    interrupt(launch)
    assert launch.returncode == 0


def test_run_finds_the_lessons_program(ros2: Ros2) -> None:
    ros2.environ["COURSE_KIT_PACKAGE_PATH"] = str(PROGRAMS.parent)
    program = ros2.begin(*OURS, "run", "lesson_programs", "parameter_node", "--ros-args", "-p", "robot_name:=r2d2")
    assert program.stderr is not None
    assert "Robot: r2d2" in program.stderr.readline()
