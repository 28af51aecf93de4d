from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import psutil
import pytest

from course_kit import environment
from course_kit.environment import paths
from course_kit.environment.middleware import PROFILE_VARIABLE

KIT_VARIABLES = (*environment.default_settings(), "ROS_DOMAIN_ID", "COURSE_KIT_DOMAIN_ID", "ROS_LOG_DIR")
DISCOVERY_GROUP = "239.255.0.1"  # of DDS; joined on the loopback interface only
DUMP = "import json, os, rclpy; rclpy.init(); print(json.dumps(dict(os.environ)))"


def in_fresh_process(program: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a program that never imports the kit, as in a terminal where nothing of the kit is set."""
    environ = {name: value for name, value in os.environ.items() if name not in KIT_VARIABLES}
    return subprocess.run(
        [sys.executable, "-c", program], env=environ | variables, capture_output=True, text=True, timeout=60, check=True
    )


def dumped(**variables: str) -> dict[str, str]:
    result: dict[str, str] = json.loads(in_fresh_process(DUMP, **variables).stdout)
    return result


def test_any_python_that_imports_rclpy_gets_the_settings() -> None:
    found = dumped()
    assert {name: found[name] for name in environment.default_settings()} == environment.default_settings()
    assert 1 <= int(found["ROS_DOMAIN_ID"]) <= 101
    assert Path(found["ROS_LOG_DIR"]).is_dir()


def test_two_programs_of_one_checkout_meet_in_one_domain() -> None:
    assert dumped()["ROS_DOMAIN_ID"] == dumped()["ROS_DOMAIN_ID"]


def test_a_value_the_user_has_set_wins() -> None:
    set_ones = {"ROS_DOMAIN_ID": "7", "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "ROS_PYTHON_CHECK_FIELDS": "0"}
    found = dumped(**set_ones, **{PROFILE_VARIABLE: "0"})
    assert {name: found[name] for name in set_ones} == set_ones
    assert found[PROFILE_VARIABLE] == "0"


def test_a_child_inherits_the_domain_and_does_not_take_it_for_the_users(domain: int) -> None:
    child = environment.child_environment(ROS_DOMAIN_ID=str(domain), ROS_LOG_DIR=None)
    assert child["ROS_DOMAIN_ID"] == str(domain)
    assert "COURSE_KIT_DOMAIN_ID" not in child
    assert "ROS_LOG_DIR" not in child


@pytest.mark.parametrize("value", ["abc", "233", "010", "\N{ARABIC-INDIC DIGIT FIVE}"])
def test_an_impossible_domain_is_named_and_not_changed(value: str) -> None:
    result = in_fresh_process("import rclpy, os; print(os.environ['ROS_DOMAIN_ID'])", ROS_DOMAIN_ID=value)
    assert result.stdout == f"{value}\n"
    assert f"ROS_DOMAIN_ID is set to '{value}'" in result.stderr
    assert "Traceback" not in result.stderr


def test_python_without_rclpy_is_left_alone() -> None:
    program = (
        "import os, sys; print('ROS_DOMAIN_ID' in os.environ, 'numpy' in sys.modules, 'rosidl_parser' in sys.modules)"
    )
    assert in_fresh_process(program).stdout.split() == ["False", "False", "False"]


def test_fields_are_checked_also_where_messages_are_imported_before_rclpy() -> None:
    program = (
        "from std_msgs.msg import Float64\nimport rclpy\ntry: Float64(data=1)\nexcept AssertionError as e: print(e)"
    )
    assert "must be of type 'float'" in in_fresh_process(program).stdout


def test_without_a_usable_home_the_state_goes_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("HOME", str(blocked))
    monkeypatch.delenv("XDG_STATE_HOME", raising=False)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    paths._state_dir.cache_clear()
    state = environment.state_dir()
    assert state.is_dir()
    assert state.is_relative_to(tmp_path)


@pytest.mark.parametrize("name", ["ROS_LOG_DIR", "ROS_HOME"])
def test_a_folder_for_logs_that_cannot_be_written_is_replaced(name: str, tmp_path: Path) -> None:
    found = dumped(**{name: "/proc/nonexistent", "XDG_STATE_HOME": str(tmp_path)})
    assert Path(found["ROS_LOG_DIR"]).is_relative_to(tmp_path)
    assert "ROS_LOG_DIR" not in dumped(ROS_HOME=str(tmp_path))


def test_old_log_files_are_cleared_away_and_the_newest_kept(tmp_path: Path) -> None:
    folder = tmp_path / "ros2-course-kit" / "log"
    folder.mkdir(parents=True)
    for number in range(200):
        file = folder / f"python_{number}.log"
        file.write_text("old")
        os.utime(file, (number, number))
    dumped(XDG_STATE_HOME=str(tmp_path))
    left = {file.name for file in folder.glob("python_*.log")}
    assert "python_199.log" in left
    assert "python_0.log" not in left
    assert len(left) <= 80


ONE_NODE = """
import os, sys
import rclpy
rclpy.init()
node = rclpy.create_node("alone")
print("up", flush=True)
sys.stdin.read()
os.kill(os.getpid(), 9)
"""


def test_the_graph_is_on_loopback_alone_and_a_killed_node_leaves_no_shared_memory(domain: int) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", ONE_NODE],
        env=environment.child_environment(ROS_DOMAIN_ID=str(domain)),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "up\n"
    maps = Path(f"/proc/{process.pid}/maps").read_text()
    sockets = psutil.Process(process.pid).net_connections("udp4")
    process.communicate()
    assert "/fastrtps_" not in maps
    assert "127.0.0.1" in {each.laddr.ip for each in sockets}
    assert {each.laddr.ip for each in sockets} <= {"127.0.0.1", DISCOVERY_GROUP}


def test_readers_and_writers_ask_alike_in_every_profile() -> None:
    """What is lost comes again after 0.1 s, for a learner and for the grader; see loopback.xml."""
    profiles = (environment.LOOPBACK_PROFILE, environment.FAST_DISCOVERY_PROFILE, environment.PRIVATE_NETWORK_PROFILE)
    times = []
    for profile in profiles:
        root = ET.parse(profile).getroot()  # noqa: S314 - our own
        ends = [one for one in root[0] if one.tag.endswith(("data_reader", "data_writer"))]
        assert [one.get("is_default_profile") for one in ends] == ["true", "true"]
        times.append({one.tag: ET.tostring(one[0]).split() for one in ends})
    assert times[0] == times[1] == times[2]


@pytest.mark.parametrize("name", ["loopback", "fast_discovery", "private_network"])
def test_fast_dds_3_is_given_the_same_profiles_in_its_spelling(name: str) -> None:
    folder = Path(environment.__file__).parent
    spelled = {"initialAcknackDelay": "initial_acknack_delay", "heartbeatPeriod": "heartbeat_period"}
    texts = [ET.tostring(ET.parse(folder / place / f"{name}.xml").getroot(), "unicode") for place in ("", "fast_dds_3")]  # noqa: S314 - our own
    for old, new in spelled.items():
        texts[0] = texts[0].replace(old, new)
    assert texts[0] == texts[1]


@pytest.mark.parametrize("by", ["AMENT_PREFIX_PATH", "prefix"])
def test_beside_fast_dds_3_its_variable_and_its_profiles_are_used(
    by: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ROS 2 Kilted and later have it; the other name brings a warning of the middleware into each program's output."""
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib/libfastdds.so").touch()
    code = f"import sys; sys.prefix = {str(tmp_path)!r}" if by == "prefix" else "import sys"
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    code += "; from course_kit import environment as e; print(*e.default_settings().items(), sep='\\n')"
    environ = {**os.environ, **({"AMENT_PREFIX_PATH": f"/nowhere:{tmp_path}"} if by != "prefix" else {})}
    said = subprocess.run([sys.executable, "-c", code], env=environ, capture_output=True, text=True, check=True).stdout
    profile = Path(environment.__file__).with_name("fast_dds_3") / "loopback.xml"
    assert f"('FASTDDS_DEFAULT_PROFILES_FILE', '{profile}')" in said
    assert "FASTRTPS" not in said
