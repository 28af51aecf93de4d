"""Knowing when the whole graph has been seen, with and without the daemon."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.environment import domains
from course_kit.ros2cli.daemon import DaemonSocket
from course_kit.ros2cli.graph import participant_sockets
from tests.waiting import wait_until

from .commands import GOLDEN, OURS, Ros2

if TYPE_CHECKING:
    from pathlib import Path

FRESH = 2  # runs


def daemon_is_running(ros2: Ros2) -> bool:
    return "is running" in ros2("daemon", "status").stdout.replace("not running", "")


@pytest.mark.parametrize("options", [(), ("--no-daemon",)])
def test_no_listing_is_empty_while_a_node_is_up(ros2: Ros2, options: tuple[str, ...]) -> None:
    ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    for _ in range(FRESH):
        assert len(ros2("service", "list", *options).stdout.splitlines()) == 8
        if not options:
            ros2("daemon", "stop")


def test_a_node_that_has_just_come_is_listed(ros2: Ros2) -> None:
    """The daemon knows the graph from before, so it must notice that there is somebody new."""
    ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    domain = int(ros2.environ["ROS_DOMAIN_ID"])
    before = participant_sockets(domain)
    newcomer = ros2.begin(sys.executable, str(GOLDEN / "demo_node.py"))
    wait_until(lambda: len(participant_sockets(domain)) > len(before), "a socket of the new node")
    assert ros2("node", "list").stdout == "/add_two_ints_server\n/robot\n"
    newcomer.kill()


def test_two_nodes_of_one_name_are_warned_about(ros2: Ros2) -> None:
    ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    domain = int(ros2.environ["ROS_DOMAIN_ID"])
    before = participant_sockets(domain)
    ros2.begin(sys.executable, str(GOLDEN / "add_server.py"))
    wait_until(lambda: len(participant_sockets(domain)) > len(before), "a socket of the second node")
    done = ros2("node", "list")
    assert done.stdout == "/add_two_ints_server\n/add_two_ints_server\n"
    assert "share an exact name" in done.stderr
    assert "There are 2 nodes" in ros2("node", "info", "/add_two_ints_server").stdout


def test_an_empty_graph_needs_no_daemon(ros2: Ros2) -> None:
    assert ros2("service", "list").stdout == ""
    assert ros2("topic", "list").stdout == "/parameter_events\n/rosout\n"
    assert not daemon_is_running(ros2)


def test_the_daemon_leaves_with_the_last_node(ros2: Ros2) -> None:
    node = ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    domain = int(ros2.environ["ROS_DOMAIN_ID"])
    assert daemon_is_running(ros2)
    node.kill()
    node.wait()
    wait_until(lambda: not participant_sockets(domain), "the end of the daemon")
    assert not daemon_is_running(ros2)


def test_the_daemon_starts_and_stops_on_request(ros2: Ros2) -> None:
    assert ros2("daemon", "start").stdout == "The daemon has been started\n"
    assert ros2("daemon", "start").stdout == "The daemon is already running\n"
    assert ros2("daemon", "stop").stdout == "The daemon has been stopped\n"
    assert ros2("daemon", "stop").stdout == "The daemon is not running\n"


def test_without_a_place_for_the_daemon_the_command_looks_itself(ros2: Ros2) -> None:
    ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    done = ros2("service", "list", "-c", XDG_STATE_HOME="/proc/nowhere", HOME="/proc/nowhere", TMPDIR="/proc/nowhere")
    assert (done.stdout, done.stderr, done.returncode) == ("8\n", "", 0)


def test_listing_imports_no_rclpy(ros2: Ros2) -> None:
    ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    run = "from course_kit.ros2cli import cli; cli.run_command(['service', 'list'])"
    code = f"import sys; {run}; print('rclpy' in sys.modules)"
    listing = ros2.begin(sys.executable, "-c", code)
    stdout, _ = listing.communicate(timeout=60)
    assert stdout.splitlines()[-1] == "False"
    assert "/add_two_ints" in stdout


def test_sockets_tell_the_participants_of_a_domain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Domain 3: discovery ports 8160, 8162, ...; 8161 is for data, 8150 for multicast, 8410 another domain's."""
    table = tmp_path / "udp"
    rows = [
        f"{n}: 00000000:{port:04X} 00000000:0000 07 0:0 0:0 0 0 0 {1000 + n} 2 0 0"
        for n, port in enumerate((8150, 8160, 8161, 8162, 8410))
    ]
    table.write_text("\n".join(["  sl  local_address ...", *rows]))
    monkeypatch.setattr(domains, "_TABLES", (str(table), str(tmp_path / "none")))
    assert participant_sockets(3) == {1001, 1003}


def test_a_listing_is_given_up_at_the_timeout(ros2: Ros2) -> None:
    """A socket in the domain that belongs to no ROS node: what has been seen by then is listed."""
    import socket

    ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        stranger.bind(("127.0.0.1", 7400 + 250 * int(ros2.environ["ROS_DOMAIN_ID"]) + 10 + 2 * 40))
        begun = time.monotonic()
        done = ros2("service", "list", "-c", "--timeout", "1")
        assert done.stdout == "8\n"
        assert time.monotonic() - begun >= 1.0


ASKS_IN_ANOTHER_NETWORK = """
import os
from course_kit.grading.sandbox import namespaces
try:
    namespaces.enter_network()
    print(os.readlink("/proc/self/ns/net"))
except OSError:
    print("refused")
from course_kit.ros2cli.daemon import DaemonSocket
from course_kit.ros2cli.graph import participant_sockets
print(DaemonSocket.for_settings().name)
"""


def test_a_daemon_in_another_network_is_not_asked(ros2: Ros2, monkeypatch: pytest.MonkeyPatch) -> None:
    """Containers with one home directory and networks of their own have different graphs on one domain."""
    for name, value in ros2.environ.items():
        monkeypatch.setenv(name, value)
    network, name = ros2.begin(sys.executable, "-c", ASKS_IN_ANOTHER_NETWORK).communicate(timeout=60)[0].split()
    assert (name == DaemonSocket.for_settings().name) == (network == "refused")


TWO_AFTER_A_COMMAND = """
import time

import rclpy
from course_kit.ros2cli.cli import run_command
run_command(["service", "list", "--no-daemon"])
contexts = [rclpy.Context() for _ in range(2)]
for context in contexts:
    context.init([], domain_id={domain})
nodes = [rclpy.create_node(f"node_{{place}}", context=context) for place, context in enumerate(contexts)]
deadline = time.monotonic() + 30
while len(nodes[0].get_node_names()) < 2 and time.monotonic() < deadline:
    time.sleep(0.01)
print(nodes[0].get_node_names())
"""


def test_after_a_command_in_a_programs_own_process_its_nodes_meet_in_other_domains(ros2: Ros2) -> None:
    """A command that is a process announces itself to its own domain alone, and Fast DDS reads that but once."""
    with environment.exclusive_domain() as other:
        program = ros2.begin(sys.executable, "-c", TWO_AFTER_A_COMMAND.format(domain=other))
        stdout, _ = program.communicate(timeout=60)
    assert stdout.splitlines()[-1] == "['node_0', 'node_1']"


def test_two_commands_that_begin_at_the_same_moment_meet(ros2: Ros2) -> None:
    """Neither is there yet when the other one looks who is."""
    ros2.start(GOLDEN / "add_server.py", "/add_two_ints_server")
    for _ in range(2):
        echo = ros2.begin(*OURS, "topic", "echo", "--once", "/chatter", "std_msgs/msg/String")
        pub = ros2.begin(*OURS, "topic", "pub", "--once", "/chatter", "std_msgs/msg/String", "data: hello")
        said, problem = pub.communicate(timeout=60)
        assert (pub.returncode, problem) == (0, ""), said
        assert echo.communicate(timeout=60)[0] == "data: hello\n---\n"


def test_nothing_of_a_command_is_left_on_the_graph(ros2: Ros2) -> None:
    ros2.start(GOLDEN / "demo_node.py", "/robot")
    called = ros2.process("service", "call", "/set_power", "std_srvs/srv/SetBool", "{data: true}")
    assert (called.returncode, "success=True" in called.stdout) == (0, True)
    left = ros2("node", "list", "--all", "--no-daemon").stdout.split()
    assert [name for name in left if "_ros2cli_daemon" not in name] == ["/robot"]
    assert "Clients count: 0" in ros2("service", "info", "/set_power", "--no-daemon").stdout
