"""What the tutorials of ROS 2 type, as they print it: verbs, options and files that the lessons do not use."""

from __future__ import annotations

import subprocess
import textwrap
from typing import TYPE_CHECKING

import pytest
import yaml

from course_kit import environment
from course_kit.ros2cli import text
from tests.waiting import wait_until

from .commands import OURS, Ros2, interrupt, lines_until

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PROGRAM = """
import rclpy
from rclpy.action import ActionServer
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Int32MultiArray, String
from std_srvs.srv import SetBool

class Guide(Node):
    def __init__(self):
        super().__init__("guide", namespace="/tour")
        self.declare_parameter("speed", 1.0)
        self.declare_parameter("name", "rover")
        self.declare_parameter("arm.reach", 2)
        self.declare_parameter("arm.reach.most", 3)
        self.declare_parameter("later", Parameter.Type.INTEGER)
        self.words = self.create_publisher(String, "words", 10)
        self.numbers = self.create_publisher(Int32MultiArray, "numbers", 10)
        self.poses = self.create_publisher(PoseStamped, "poses", 10)
        self.server = self.create_service(SetBool, "power", self.power)
        self.server.configure_introspection(
            self.get_clock(), qos_profile_services_default, ServiceIntrospectionState.CONTENTS)
        self.action = ActionServer(self, Fibonacci, "count", self.count)
        self.hidden = self.create_publisher(Fibonacci.Impl.FeedbackMessage, "quick/_action/feedback", 10)
        self.sent = 0
        self.create_timer(0.05, self.tick)

    def power(self, request, response):
        response.success = request.data
        response.message = "and so on..."
        return response

    def count(self, goal):
        goal.publish_feedback(Fibonacci.Feedback(sequence=[goal.request.order]))
        goal.succeed()
        return Fibonacci.Result(sequence=[goal.request.order])

    def tick(self):
        self.sent += 1
        self.words.publish(String(data=["wait...", "go"][self.sent % 2]))
        self.numbers.publish(Int32MultiArray(data=[self.sent % 2, 7]))
        self.hidden.publish(Fibonacci.Impl.FeedbackMessage())
        pose = PoseStamped()
        pose.header.stamp = self.get_clock().now().to_msg()
        self.poses.publish(pose)

rclpy.init()
rclpy.spin(Guide())
"""


@pytest.fixture(scope="module")
def guide(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros2]:
    folder = tmp_path_factory.mktemp("guide")
    (folder / "guide.py").write_text(PROGRAM)
    with environment.exclusive_domain() as domain, Ros2(domain, folder) as command:
        command.start(folder / "guide.py", "/tour/guide")
        yield command


def output(guide: Ros2, *words: str) -> str:
    done = guide(*words)
    assert (done.returncode, done.stderr) == (0, ""), done
    return done.stdout


@pytest.mark.parametrize("name", ["tour/guide:", "/tour/**:"])
def test_a_file_of_parameters_names_its_node_in_any_way(guide: Ros2, name: str) -> None:
    """Whatever rcl takes when a program is started with it (ROS design article "ROS Command Line Arguments")."""
    depth = "  " * name.count("\n") + "  "
    file = guide.folder / "parameters.yaml"
    file.write_text(f"{name}\n{depth}ros__parameters:\n{depth}  speed: 2.5\n{depth}  arm:\n{depth}    reach: 5\n")
    shown = output(guide, "param", "load", "/tour/guide", "parameters.yaml")
    assert sorted(shown.splitlines()) == ["Set parameter arm.reach successful", "Set parameter speed successful"]
    assert output(guide, "param", "get", "/tour/guide", "speed") == "Double value is: 2.5\n"


def test_the_own_section_of_a_file_wins(guide: Ros2) -> None:
    file = guide.folder / "both.yaml"
    file.write_text(
        "/tour/guide: {ros__parameters: {speed: 3.0}}\n"
        "/**: {ros__parameters: {speed: 1.5, name: all}}\n"
        "/other: {ros__parameters: {speed: 9.0}}\n"
    )
    output(guide, "param", "load", "/tour/guide", "both.yaml")
    assert output(guide, "param", "get", "/tour/guide", "speed") == "Double value is: 3.0\n"
    assert output(guide, "param", "get", "/tour/guide", "name") == "String value is: all\n"
    output(guide, "param", "set", "/tour/guide", "name", "rover")
    output(guide, "param", "load", "/tour/guide", "both.yaml", "--no-use-wildcard")
    assert output(guide, "param", "get", "/tour/guide", "name") == "String value is: rover\n"


@pytest.mark.parametrize(
    ("content", "wanted"),
    [
        ("/tour/gide: {ros__parameters: {speed: 3.0}}", "no parameters for /tour/guide. It has some for /tour/gide."),
        ("speed: 1.0", "there is no ros__parameters under /speed"),
        ("a: [1", "is not valid YAML"),
        ("", "is not a file of parameters"),
    ],
)
def test_a_file_that_is_none_is_named(guide: Ros2, content: str, wanted: str) -> None:
    (guide.folder / "wrong.yaml").write_text(content)
    done = guide("param", "load", "/tour/guide", "wrong.yaml")
    assert (done.returncode, done.stdout) == (1, "")
    assert wanted in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_parameter_that_is_declared_without_a_value(guide: Ros2) -> None:
    assert output(guide, "param", "get", "/tour/guide", "later") == "Parameter not set.\n"
    assert output(guide, "param", "describe", "/tour/guide", "later").startswith("Parameter name: later\n  Type: ")
    assert "has no 'latr'. Did you mean later?" in guide("param", "get", "/tour/guide", "latr").stderr


def test_a_dump_of_a_parameter_whose_name_is_that_of_a_group_too(guide: Ros2) -> None:
    dumped = yaml.safe_load(output(guide, "param", "dump", "/tour/guide", "--include-hidden-nodes"))
    assert sorted(dumped["/tour/guide"]["ros__parameters"]["arm"]) == ["reach", "reach.most"]


def test_dots_at_the_end_of_a_text_stay(guide: Ros2) -> None:
    shown = output(guide, "topic", "echo", "--once", "--filter", "m.data.startswith('wait')", "/tour/words")
    assert shown == "data: wait...\n---\n"
    long = text.to_yaml(_string("x" * 200), text.Layout())
    assert long == f"data: {'x' * 128}...\n"
    assert text.to_yaml("plain") == "plain\n"


def _string(content: str) -> object:
    from std_msgs.msg import String

    return String(data=content)


@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        (("--field", "data"), "array('i', [1, 7])\n---\n"),
        (("--csv",), "0,1,7\n"),
        (("--raw",), "b'\\x00\\x01\\x00\\x00"),
        (("-i",), "---Got new message, message info:---\n{'source_timestamp': "),
    ],
)
def test_echo_shows_messages_as_the_real_one_does(guide: Ros2, options: tuple[str, ...], wanted: str) -> None:
    only = () if "--raw" in options or "--field" in options else ("--filter", "m.data[0] == 1")
    if "--field" in options:
        only = ("--filter", "m[0] == 1")
    assert wanted in output(guide, "topic", "echo", "--once", *options, *only, "/tour/numbers")


@pytest.mark.parametrize(
    ("expression", "wanted"),
    [("m.data ==", "is not a Python expression"), ("m.nothing", "has failed: AttributeError")],
)
def test_a_wrong_filter_is_named(guide: Ros2, expression: str, wanted: str) -> None:
    done = guide("topic", "echo", "--once", "--filter", expression, "/tour/words")
    assert done.returncode == 1
    assert wanted in done.stderr
    assert "Traceback" not in done.stderr


def test_an_unknown_topic_is_told_at_once(guide: Ros2) -> None:
    done = guide("topic", "echo", "/tour/wrds", "--timeout", "3600")
    assert done.returncode == 1
    assert done.stderr == (
        "Could not determine the type of /tour/wrds: nobody uses this topic. Did you mean /tour/words?\n"
    )


def test_feedback_and_service_events_are_topics(guide: Ros2) -> None:
    feedback = guide.begin(*OURS, "topic", "echo", "--once", "/tour/count/_action/feedback")
    events = guide.begin(*OURS, "service", "echo", "/tour/power")
    for listener in ("/tour/count/_action/feedback", "/tour/power/_service_event"):
        while "Subscription count: 1" not in guide("topic", "info", listener).stdout:
            assert feedback.poll() is None
            assert events.poll() is None
    output(guide, "action", "send_goal", "/tour/count", "example_interfaces/action/Fibonacci")
    assert "sequence:" in "".join(lines_until(feedback, "---"))
    output(guide, "service", "call", "/tour/power", "std_srvs/srv/SetBool")
    assert "event_type: REQUEST_RECEIVED" in "".join(lines_until(events, "---"))
    assert "event_type: RESPONSE_SENT" in "".join(lines_until(events, "---"))
    interrupt(events)


def test_a_time_of_now_is_that_of_each_message(guide: Ros2) -> None:
    shown = output(
        guide, "topic", "pub", "-w", "0", "-t", "2", "-r", "20", "/tour/stamps", "std_msgs/msg/Header", "stamp: now"
    )
    stamps = [line for line in shown.splitlines() if line.startswith("publishing")]
    assert len(stamps) == 2
    assert stamps[0].partition(": ")[2] != stamps[1].partition(": ")[2]


def test_the_node_of_a_publisher_may_have_a_name(guide: Ros2) -> None:
    done = guide("topic", "pub", "--once", "-w", "1", "--max-wait-time-secs", "0.5", "/tour/said", "std_msgs/msg/Empty")
    assert done.returncode == 1
    assert "Nobody subscribed to /tour/said within 0.5 s" in done.stderr
    named = guide.begin(*OURS, "topic", "pub", "-n", "speaker", "/tour/said", "std_msgs/msg/String", "data: hi")
    lines_until(named, "publishing #1")
    assert "/speaker" in output(guide, "node", "list").splitlines()
    interrupt(named)


def test_standard_input(guide: Ros2) -> None:
    words = [*OURS, "topic", "pub", "--stdin", "-w", "0", "--once", "/tour/said", "std_msgs/msg/String"]
    done = subprocess.run(
        words, input="data: typed\n", env=guide.environ, capture_output=True, text=True, timeout=60, check=True
    )
    assert "std_msgs.msg.String(data='typed')" in done.stdout
    words = [*OURS, "service", "call", "/tour/power", "std_srvs/srv/SetBool", "--stdin"]
    done = subprocess.run(
        words, input="{data: true}", env=guide.environ, capture_output=True, text=True, timeout=60, check=True
    )
    assert "SetBool_Request(data=True)" in done.stdout


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (("hz", "/tour/words", "--filter", "m.data == 'go'"), "average rate: "),
        (("bw", "/tour/words"), "B/s from "),
        (("delay", "/tour/poses"), "average delay: "),
    ],
)
def test_figures_come_each_second(guide: Ros2, words: tuple[str, ...], wanted: str) -> None:
    measuring = guide.begin(*OURS, "topic", *words)
    assert wanted in lines_until(measuring, wanted)[-1]
    interrupt(measuring)


def test_find_lists_by_type(guide: Ros2) -> None:
    assert output(guide, "topic", "find", "std_msgs/msg/String") == "/tour/words\n"
    assert output(guide, "topic", "find", "-c", "std_msgs/String") == "1\n"
    assert output(guide, "service", "find", "std_srvs/srv/SetBool") == "/tour/power\n"


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (("bag", "record"), "'bag' exists in ROS 2; this course does not have it"),
        (("pkg", "create", "x"), "'create' exists in ROS 2; this course does not have it"),
        (("launch", "-d", "it.launch.py"), "-d exists in ROS 2; this course does not have it"),
        (("topic", "echo", "/x", "--qos-liveliness", "automatic"), "--qos-liveliness exists in ROS 2"),
        (
            ("service", "call", "/x", "std_srvs/srv/SetBool", "{data:", "true}"),
            "the shell has taken the values apart (left over: true}): put '...' around {...}",
        ),
    ],
)
def test_what_only_the_real_one_has_is_told_apart_from_a_typo(guide: Ros2, words: tuple[str, ...], wanted: str) -> None:
    done = guide(*words)
    assert done.returncode == 2
    assert wanted in done.stderr


def test_the_doctor_says_who_is_alone_and_who_does_not_fit(guide: Ros2) -> None:
    done = guide("doctor")
    assert done.returncode == 0
    assert "UserWarning: Publisher without subscriber detected on /tour/words.\n" in done.stderr
    assert done.stdout.startswith("\nAll 4 checks passed\n")
    assert "1/4 check(s) failed\n\nFailed modules: topic\n" in guide("wtf", "--include-warnings").stdout
    listener = guide.begin(*OURS, "topic", "echo", "/tour/words", "--qos-durability", "transient_local")
    wait_until(lambda: "error found on topic '/tour/words': " in guide("doctor").stderr, "the subscription")
    done = guide("doctor")
    interrupt(listener)
    assert "UserWarning: ERROR: QoS compatibility error found on topic '/tour/words': " in done.stderr
    assert "1/4 check(s) failed\n\nFailed modules: middleware\n" in done.stdout


SETUP = """
from setuptools import find_packages, setup
package_name = 'py_pubsub'
raise SystemExit('it was run')
setup(
    name=package_name,
    entry_points={
        'console_scripts': [
                'talker = py_pubsub.publisher_member_function:main',
                'listener = py_pubsub.subscriber_member_function:main',
        ],
    },
)
"""


def test_the_tutorials_package_runs_from_its_folder(guide: Ros2, tmp_path: Path) -> None:
    """As "Writing a simple publisher and subscriber (Python)" makes it; its setup.py is read, not run."""
    package = tmp_path / "ros2_ws" / "src" / "py_pubsub"
    (package / "py_pubsub").mkdir(parents=True)
    (package / "setup.py").write_text(SETUP)
    (package / "py_pubsub" / "__init__.py").write_text("")
    (package / "py_pubsub" / "publisher_member_function.py").write_text(
        textwrap.dedent("""
            import sys
            def main():
                print("talking as", sys.argv)
        """)
    )
    for folder in (package, package.parent.parent):
        here = Ros2(int(guide.environ["ROS_DOMAIN_ID"]), folder)
        done = here.process("run", "py_pubsub", "talker", "--ros-args")
        assert (done.returncode, done.stdout) == (0, "talking as ['talker', '--ros-args']\n"), done.stderr
    assert here("pkg", "executables", "py_pubsub").stdout == "py_pubsub listener\npy_pubsub talker\n"
    assert here("pkg", "prefix", "py_pubsub").stdout == f"{package}\n"
