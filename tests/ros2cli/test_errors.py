"""What goes wrong is one line on stderr with the nearest right name, and soon."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from course_kit.ros2cli.cli import run_command
from course_kit.ros2cli.verbs import param
from tests.background import IN_BACKGROUND

from .commands import GOLDEN, OURS, interrupt, lines_until

if TYPE_CHECKING:
    from pathlib import Path

    from .commands import Ros2


@pytest.fixture
def robots_domain(robot: Ros2, monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands in this process, for speed, see the robot as well."""
    monkeypatch.setenv("ROS_DOMAIN_ID", robot.environ["ROS_DOMAIN_ID"])


CALL = ("service", "call")
FAULTY = """
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool

class Faulty(Node):
    def __init__(self):
        super().__init__("faulty")
        self.create_service(SetBool, "fail", self.fail)

    def fail(self, *_):
        raise ValueError("too fast")

rclpy.init()
rclpy.spin(Faulty())
"""


@pytest.mark.parametrize(
    ("words", "exit_code", "wanted"),
    [
        (("service", "lst"), 2, "there is no 'lst'. Did you mean list?"),
        (("service", "list", "--bogus"), 2, "unknown: --bogus"),
        (("service", "type", "/set_powr"), 1, "Unknown service '/set_powr'. Did you mean /set_power?"),
        ((*CALL, "/set_power", "std_srvs/srv/SetBol"), 1, "Did you mean std_srvs/srv/SetBool?"),
        ((*CALL, "/set_power", "std_msgs/msg/String"), 1, "std_msgs/msg/String is not a service type"),
        ((*CALL, "/set_powr", "std_srvs/srv/SetBool", "--timeout", "1"), 1, "within 1 s. Did you mean /set_power?"),
        ((*CALL, "/set_power", "std_srvs/srv/Trigger"), 1, "a service of the type std_srvs/srv/SetBool, not"),
        (("action", "send_goal", "/fibonacci", "test_msgs/action/Fibonacci", "{order: 1.5}"), 1, "'order' is an int32"),
        (("param", "get", "/robot", "max_velocty"), 1, "Did you mean max_velocity?"),
        (("param", "set", "/robot", "max_velocity", "@1"), 1, "is not a parameter value"),
        (("topic", "echo", "/in", "--timeout", "1"), 1, "No message on /in for 1 s; no publishers on it."),
        (("topic", "echo", "/chatter", "--field", "dta"), 1, "no field 'dta' in the message. Did you mean data?"),
        (
            ("topic", "pub", "-1", "/nobody", "std_msgs/String", "--timeout", "1"),
            1,
            "Nobody subscribed to /nobody within 1 s (waiting for 1)",
        ),
        (("launch", "turtlesim", "it.launch.py"), 1, "Package 'turtlesim' not found: it comes with a full ROS 2"),
        (("run", "nowhere", "nothing"), 1, "Package 'nowhere' not found"),
    ],
    ids=lambda value: " ".join(value[:3]) if isinstance(value, tuple) else "",
)
@pytest.mark.usefixtures("robots_domain")
def test_one_line_that_helps(
    capsys: pytest.CaptureFixture[str], words: tuple[str, ...], exit_code: int, wanted: str
) -> None:
    code = run_command(words)
    said = capsys.readouterr().err
    assert wanted in said
    assert len(said.splitlines()) == 1
    assert code == exit_code


def test_a_server_that_ends_instead_of_answering(ros2: Ros2, tmp_path: Path) -> None:
    words = (*CALL, "/fail", "std_srvs/srv/SetBool")
    script = tmp_path / "faulty.py"
    script.write_text(FAULTY)
    program = ros2.start(script, "/faulty")
    done = ros2(*words, "--timeout", "900")  # for so long no command of a test runs
    assert f"{words[2]} went away before it answered: its program has ended." in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert done.returncode == 1
    assert program.wait(30) == 1


def test_an_unknown_action_has_nobody_and_a_hint(robot: Ros2) -> None:
    done = robot("action", "info", "/fibonaci")
    assert done.stdout == "Action: /fibonaci\nAction clients: 0\nAction servers: 0\n"
    assert "Did you mean /fibonacci?" in done.stderr
    assert done.returncode == 0


@pytest.mark.parametrize(
    ("words", "lines"),
    [
        (("--help",), ["    interface  show the text of messages, services and actions", "commands:"]),
        (("topic", "pub", "--help"), ["  -r, --rate N                  messages a second (default: 1)"]),
    ],
)
def test_help_looks_alike_on_every_python(ros2: Ros2, words: tuple[str, ...], lines: list[str]) -> None:
    """Jupyter's kernels set FORCE_COLOR, which Python 3.14 heeds."""
    done = ros2(*words, FORCE_COLOR="1", COLUMNS="wide")  # which is no width
    assert (done.returncode, done.stderr) == (0, "")
    assert set(lines) <= set(done.stdout.splitlines())


def test_ctrl_c_ends_a_command_that_a_script_started_in_the_background(robot: Ros2) -> None:
    command = robot.begin(*IN_BACKGROUND, *OURS, "topic", "echo", "/chatter")
    lines_until(command, "data: hello")
    _, errors = interrupt(command)
    assert (command.returncode, errors) == (2, "")


def test_a_reader_that_has_seen_enough_is_no_error(robot: Ros2) -> None:
    import shlex
    import subprocess

    pipe = f"{shlex.join(OURS)} topic echo /chatter | head -n 1"
    done = subprocess.run(pipe, shell=True, env=robot.environ, capture_output=True, text=True, timeout=60, check=True)  # noqa: S602
    assert "data: hello" in done.stdout
    assert done.stderr == ""


@pytest.mark.usefixtures("robots_domain")
def test_a_node_that_is_just_starting_is_waited_for(
    robot: Ros2, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tutorial's launch file starts turtlesim and a `ros2 param set` for it at the same time."""
    monkeypatch.setattr(param, "_STARTS_WITHIN", 60.0)  # on a busy machine, too
    late = robot.begin(sys.executable, str(GOLDEN / "demo_node.py"), "--ros-args", "-r", "__node:=late")
    assert run_command(("param", "set", "/late", "max_velocity", "2.0", "--timeout", "60")) == 0
    assert capsys.readouterr().out == "Set parameter successful\n"
    late.kill()
