"""Programs that attack by what they send, print and answer: each costs its own points, and the grader never fails.

In every one of them something is right, so that the checks go on; what is wrong is far too long, or of no sort at all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

SERVICE, MOVE, LIMITER, CHOICE = "temperature_service", "move_robot", "robot_parameters", "pattern_choice"
LONGEST_REPORT = 256 * 1024  # bytes of JSON
pytestmark = [pytest.mark.answers, pytest.mark.timeout(300), pytest.mark.attack("What a submission sends")]


def solution(exercise: str) -> str:
    return (ROOT / "solutions" / exercise / f"{exercise}.py").read_text()


def changed(exercise: str, *changes: tuple[str, str]) -> str:
    source = solution(exercise)
    for before, after in changes:
        assert source.count(before) == 1, before
        source = source.replace(before, after)
    return source


@pytest.fixture
def grade(worker: grading.Worker, tmp_path: Path) -> Callable[[str, str], grading.Report]:
    """Grades a text, and sees that the grader has not failed and that the report is a short one."""

    def run(exercise: str, source: str) -> grading.Report:
        path = tmp_path / "answer.py"
        path.write_text(source)
        report = grading.grade(exercise, path, worker=worker, seed=3)
        assert report.status != "error", report.problem
        assert {check.status for check in report.checks} <= {"passed", "failed", "skipped"}
        assert len(report.to_json().encode()) < LONGEST_REPORT
        assert len(grading.render_html(report).encode()) < 2 * LONGEST_REPORT
        return report

    return run


def failed(report: grading.Report) -> set[str]:
    return {check.id for check in report.checks if check.status == "failed"}


TELL = 'self.status.publish(String(data=f"{name}: {highest} m/s"))'
STATUS_LINES = {
    "12,000 spaces": 'self.status.publish(String(data=" " * 12_000))',
    "8 MB": 'self.status.publish(String(data="x" * (8 << 20)))',
    "8 MB of emoji": 'self.status.publish(String(data="\\U0001f600" * (2 << 20)))',
    "no UTF-8": r'self.status.publish(b"\0\1\0\0" b"\5\0\0\0" b"\xff\xfe\xff\xfe\0")',
}


@pytest.mark.parametrize("line", STATUS_LINES)
def test_a_status_line_costs_the_points_for_the_status(line: str, grade: Callable[..., grading.Report]) -> None:
    report = grade(LIMITER, changed(LIMITER, (TELL, STATUS_LINES[line])))
    assert failed(report) == {"status"}
    check = next(one for one in report.checks if one.id == "status")
    assert "of the form" in check.message or "have the form" in check.message


def test_a_status_line_that_is_no_message_is_none(grade: Callable[..., grading.Report]) -> None:
    report = grade(LIMITER, changed(LIMITER, (TELL, r'self.status.publish(b"\0\1\0\0\xff\xff\xff\x7f")')))
    assert failed(report) == {"status"}
    assert {check.diagnosis for check in report.checks if check.status == "failed"} == {"topic.silent"}


def test_a_flood_on_one_topic_costs_the_points_for_that_one(grade: Callable[..., grading.Report]) -> None:
    """One that leaves the rest of the program some time: a period of a millisecond instead of half a second."""
    report = grade(LIMITER, changed(LIMITER, ("STATUS_PERIOD = 0.5", "STATUS_PERIOD = 0.001")))
    assert failed(report) == {"status_rate"}


def test_long_names_and_reasons_of_parameters(grade: Callable[..., grading.Report]) -> None:
    changes = (
        ('"default_robot")', '"default_robot" * 600_000)'),
        ('reason="robot_name must not be empty"', 'reason="robot_name must not be empty" * 200_000'),
    )
    assert {"defaults", "status"} <= failed(grade(LIMITER, changed(LIMITER, *changes)))


NOT_RCLPYS = """
import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.node import Node
from std_msgs.msg import Float64, String

NAMES = ["robot_name", "max_velocity", "wheel_diameter", "enabled"]
GOOD = dict(zip(NAMES, [ParameterValue(type=4, string_value="x"), ParameterValue(type=3, double_value={velocity}),
                        ParameterValue(type=3, double_value={diameter}), ParameterValue(type=1, bool_value=True)]))
asked = 0

def list_names(request, response):
    response.result.names = NAMES
    return response

def get(request, response):
    global asked
    asked += 1
    response.values = [{answer} for name in request.names]
    return response

rclpy.init()
node = Node("velocity_limiter", start_parameter_services=False)
speed = node.create_publisher(Float64, "wheel_speed", 10)
velocity = node.create_publisher(Twist, "cmd_vel", 10)
status = node.create_publisher(String, "status", 10)

def drive(command):
    velocity.publish(command)
    speed.publish(Float64(data=float("inf")))

node.create_subscription(Twist, "cmd_vel_in", drive, 10)
node.create_timer(0.5, lambda: status.publish(String(data="x: 1.0 m/s")))
for kind, name in ((ListParameters, "list_parameters"), (GetParameters, "get_parameters"),
                   (SetParameters, "set_parameters"), (SetParametersAtomically, "set_parameters_atomically")):
    answer = {{"list_parameters": list_names, "get_parameters": get}}.get(name, lambda request, response: response)
    node.create_service(kind, f"~/{{name}}", answer)
rclpy.spin(node)
"""
PARAMETERS = {
    "of a type that does not exist": ("1.0", "0.1", "ParameterValue(type=77)"),
    "that change their type": ("1.0", "0.1", "GOOD[name] if asked < 6 else ParameterValue(type=1)"),
    "that divide by zero": ("1.0", "0.0", "GOOD[name]"),
    "that are no numbers": ("float('nan')", "5e-324", "GOOD[name]"),
}


@pytest.mark.parametrize("what", PARAMETERS)
def test_parameters_of_a_node_that_answers_for_them_itself(what: str, grade: Callable[..., grading.Report]) -> None:
    velocity, diameter, answer = PARAMETERS[what]
    report = grade(LIMITER, NOT_RCLPYS.format(velocity=velocity, diameter=diameter, answer=answer))
    assert failed(report)
    assert not report.passed


ANSWERED = "        response.success = not response.message\n"


@pytest.mark.parametrize("success", ["not response.message", "True"])
def test_service_answers_of_8_mb(success: str, grade: Callable[..., grading.Report]) -> None:
    """What a slow machine makes of them is another matter: they may come too late."""
    long = f'        response.success = {success}\n        response.message = "x" * (8 << 20)\n'
    report = grade(SERVICE, changed(SERVICE, (ANSWERED, long)))
    passed = {check.id for check in report.checks if check.status == "passed"}
    assert {"offered", "node_name"} <= passed
    assert ("unknown_unit" not in passed) or success != "True"


def test_action_results_of_8_mb(grade: Callable[..., grading.Report]) -> None:
    report = grade(MOVE, changed(MOVE, ("message=message)", 'message="\\n" * (8 << 20))')))
    assert {"offered", "node_name", "accepted"} <= {check.id for check in report.checks if check.status == "passed"}


def test_feedback_without_end_is_still_feedback(grade: Callable[..., grading.Report]) -> None:
    before = "            self.robot.step_towards(*target)\n"
    more = """            for _ in range(200):
                goal_handle.publish_feedback(
                    MoveRobot.Feedback(
                        position=self.point(), distance_remaining=remaining, progress=1.0 - remaining / whole_way
                    )
                )
"""
    report = grade(MOVE, changed(MOVE, (before, more + before)))
    assert {"feedback", "progress"} <= {check.id for check in report.checks if check.status == "passed"}


FORGED = {
    "a line with too many digits": (
        'Traceback (most recent call last):\\n  File "answer.py", line ' + "1" * 5000 + ", in f\\nValueError: x",
        "start.crash",
    ),
    "a module that ends whoever imports it": (
        "Traceback (most recent call last):\\nImportError: cannot import name 'x' from 'pip.__main__' (y)",
        "start.import",
    ),
    "a name without end": (
        "Traceback (most recent call last):\\nImportError: cannot import name '" + "x" * 7000 + "' from 'rclpy'",
        "start.import",
    ),
}


@pytest.mark.parametrize("what", FORGED)
def test_forged_tracebacks(what: str, grade: Callable[..., grading.Report]) -> None:
    text, diagnosis = FORGED[what]
    report = grade(SERVICE, f"import sys\nsys.stderr.write({text!r}.encode().decode('unicode_escape'))\nsys.exit(1)\n")
    assert (report.status, report.checks[0].diagnosis) == ("crashed", diagnosis)


EVERYWHERE = """
import os, threading, time

def write():
    own = [number for number in range(3, 256) if os.path.exists(f"/proc/self/fd/{{number}}")]
    while True:
        for number in own:
            try:
                os.write(number, {data})
            except OSError:
                pass
        {pause}

threading.Thread(target=write, daemon=True).start()
"""
WRITTEN = {
    "a flood": ("b'Thread 0x1 (most recent call first):\\n' * 1000", "pass"),
    "a trickle": ("b'x'", "time.sleep(0.001)"),
    "notes": ("b'\\n{\"note\": {\"functions\": [' + b'\"f\",' * 9000 + b'1]}}\\n'", "time.sleep(0.01)"),
}


@pytest.mark.parametrize("what", WRITTEN)
def test_writing_without_end_where_the_runner_leaves_its_notes(what: str, grade: Callable[..., grading.Report]) -> None:
    data, pause = WRITTEN[what]
    stuck = "        import time\n        time.sleep(100)\n"
    source = changed(SERVICE, (ANSWERED, ANSWERED + stuck))
    report = grade(SERVICE, EVERYWHERE.format(data=data, pause=pause) + source)
    assert "answers" in failed(report)


ANSWERS = {
    "half of a character": 'answers = {"weld_seam": ("\\ud800", "\\udfff"), "\\ud800": ("a", "b")}',
    "a number with too many digits": f'answers = {{"weld_seam": (0x{"1" * 90_000}, "a"), 0x{"2" * 9000}: 1}}',
    "two thousand entries": f"answers = {{{', '.join(f'{number}: 1' for number in range(2000))}}}",
    "two thousand entries that look alike": f"answers = {{{', '.join(f'weld_seam{n}: 1' for n in range(2000))}}}",
    "one of 1 MB": f'answers = {{"weld_seam": "{"a" * 1_000_000}"}}',
    "worked out": 'answers = dict([("weld_seam", ("\\ud800", 10**6000)), ("x" * 5000, 2), (10**5000, 3), ((), [])])',
    "lists in each other": f'answers = {{"weld_seam": {"[" * 90}{"]" * 90}}}',
    "a sum": f'answers = {{"weld_seam": {"1+" * 900}1}}',
}


@pytest.mark.parametrize("what", ANSWERS)
def test_answers_nobody_would_write(what: str, grade: Callable[..., grading.Report]) -> None:
    report = grade(CHOICE, ANSWERS[what])
    assert report.score == 0.0
    report.to_json().encode()  # half a character could not be written
