"""The commands of the chapter the course grew from, one by one, against its programs as they stand."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment

from .commands import OURS, SEED, Ros2, interrupt, lines_until

if TYPE_CHECKING:
    from collections.abc import Iterator

FIBONACCI = ("action", "send_goal", "/fibonacci", "example_interfaces/action/Fibonacci", "{order: 5}")


@pytest.fixture(scope="module")
def chapter(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros2]:
    """The command, where the chapter's three servers run."""
    folder = tmp_path_factory.mktemp("chapter")
    with environment.exclusive_domain() as domain, Ros2(domain, folder) as command:
        command.start(SEED / "minimal_service.py", "/minimal_service")
        command.start(SEED / "fibonacci_action_server.py", "/fibonacci_action_server")
        command.start(SEED / "parameter_node.py", "/parameter_node")
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
def test_command_of_the_chapter(chapter: Ros2, words: tuple[str, ...], wanted: str) -> None:
    done = chapter(*words)
    assert wanted in done.stdout
    assert (done.returncode, done.stderr) == (0, "")


def test_the_chapters_client_beside_the_command(chapter: Ros2) -> None:
    client = chapter.begin(sys.executable, str(SEED / "minimal_client.py"), "2", "3")
    _, stderr = client.communicate(timeout=60)
    assert "Result of add_two_ints: 5" in stderr


def test_the_chapters_launch_file(ros2: Ros2) -> None:
    launch = ros2.begin(*OURS, "launch", str(SEED / "parameter_node.launch.py"))
    shown = "".join(lines_until(launch, "Wheel diameter"))
    assert "[parameter_node-1]: process started" in shown
    assert ros2("param", "get", "/parameter_node", "robot_name").stdout == "String value is: turtlebot4\n"
    assert ros2("param", "get", "/parameter_node", "max_velocity").stdout == "Double value is: 2.0\n"
    interrupt(launch)
    assert launch.returncode == 0


def test_run_finds_the_chapters_program(ros2: Ros2) -> None:
    ros2.environ["COURSE_KIT_PACKAGE_PATH"] = str(SEED.parent)
    program = ros2.begin(*OURS, "run", "seed", "parameter_node", "--ros-args", "-p", "robot_name:=r2d2")
    assert program.stderr is not None
    assert "Robot: r2d2" in program.stderr.readline()
