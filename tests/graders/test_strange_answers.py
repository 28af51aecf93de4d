"""Whatever a submission answers, it gets a verdict: an error of the grader comes from the grader or the machine."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

import pytest

from course_kit.authoring.corpus import ProofSubmission
from course_kit.authoring.gradings import Gradings
from course_kit.grading.model.exercise import load_exercise
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading import Report

ANYTHING = ("", None)


@dataclass(frozen=True)
class Strange:
    """One of them."""

    exercise: str
    first: tuple[str, str | None]  # the check that fails first, with its diagnosis, unless it depends on who is faster
    changes: tuple[tuple[str, str], ...] = field(default=())  # what replaces what in the solution
    source: str = ""  # the whole program, where it is not made from the solution

    def text(self) -> str:
        """The program."""
        if self.source:
            return self.source
        text = _solution(self.exercise)
        for old, new in self.changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        return text


@lru_cache
def _solution(exercise: str) -> str:
    return (ROOT / "solutions" / exercise / f"{exercise}.py").read_text()


def _service(body: str) -> tuple[tuple[str, str], ...]:
    """The service with another beginning of its callback."""
    return (('        """Answer one request; a refusal carries its reason."""\n', body),)


def _made_with(arguments: str) -> tuple[tuple[str, str], ...]:
    """The service with more arguments at its making."""
    return (
        ('"convert_temperature", self.convert', f'"convert_temperature", self.convert, {arguments}'),
        ("import rclpy\n", "import rclpy\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n"),
    )


def _result(fields: str) -> tuple[tuple[str, str], ...]:
    """The action with another result."""
    return (
        ("final_position=self.point(), distance_travelled=travelled, message=message", fields),
        ("import math\n", "import math\nfrom math import inf, nan\n"),
    )


def _limiter(*changes: tuple[str, str]) -> tuple[tuple[str, str], ...]:
    return (("import math\n", "import math\nfrom math import inf, nan\n"), *changes)


# The same name on the wire, and other fields behind it: what the grader gets is no message of the type.
_OTHER_FIELDS = """
import os
import sys
if not os.path.isdir("data"):
    os.makedirs("data/course_interfaces/srv")
    with open("data/course_interfaces/srv/ConvertTemperature.srv", "w") as file:
        file.write("float64 value\\nstring from_unit\\nstring to_unit\\n---\\n")
        file.write("uint8 success\\nstring value\\nuint64[] message\\n")
    os.execv(sys.executable, [sys.executable, __file__])  # a process in which the type is not yet imported
from course_kit.interfaces import sources
sources.OWN_FOLDER = os.path.abspath("data")
import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.node import Node

class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.create_service(ConvertTemperature, "convert_temperature", self.convert)

    def convert(self, request, response):
        response.success, response.value, response.message = 77, "\\xff" * 200, [2**64 - 1] * 100
        return response

rclpy.init()
rclpy.spin(TemperatureService())
"""
# The five parts of an action made one by one, so that they can say what an ActionServer never would.
_ACTION_BY_HAND = """
import rclpy
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from course_interfaces.action import MoveRobot
from rclpy.node import Node

PARTS = MoveRobot.Impl

class MoveRobotServer(Node):
    def __init__(self):
        super().__init__("move_robot_server")
        name = "/move_robot/_action/"
        self.create_service(PARTS.SendGoalService, name + "send_goal", self.accept)
        self.create_service(PARTS.CancelGoalService, name + "cancel_goal", lambda _, response: response)
        self.create_service(PARTS.GetResultService, name + "get_result", self.result)
        self.create_publisher(PARTS.FeedbackMessage, name + "feedback", 10)
        self.status = self.create_publisher(GoalStatusArray, name + "status", 10)

    def accept(self, request, response):
        response.accepted = True
        entry = GoalStatus(goal_info=GoalInfo(goal_id=request.goal_id), status=77)
        self.status.publish(GoalStatusArray(status_list=[entry] * 3000))
        return response

    def result(self, request, response):
        response.status = STATUS
        return response

rclpy.init()
rclpy.spin(MoveRobotServer())
"""
# The parameter services made by hand; VALUES is what get_parameters answers from the fifth question on.
_PARAMETERS_BY_HAND = """
import math
import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import ParameterValue, SetParametersResult
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.node import Node
from std_msgs.msg import Float64, String

RIGHT = {
    "robot_name": ParameterValue(type=4, string_value="default_robot"),
    "max_velocity": ParameterValue(type=3, double_value=1.0),
    "wheel_diameter": ParameterValue(type=3, double_value=0.1),
    "enabled": ParameterValue(type=1, bool_value=True),
}

class VelocityLimiter(Node):
    def __init__(self):
        super().__init__("velocity_limiter", start_parameter_services=False)
        self.asked = 0
        for interface, name, answer in (
            (ListParameters, "list_parameters", self.names),
            (GetParameters, "get_parameters", self.values),
            (SetParameters, "set_parameters", self.set_each),
            (SetParametersAtomically, "set_parameters_atomically", self.set_all),
        ):
            self.create_service(interface, "/velocity_limiter/" + name, answer)
        self.cmd_vel = self.create_publisher(Twist, "cmd_vel", 10)
        self.wheel_speed = self.create_publisher(Float64, "wheel_speed", 10)
        self.status = self.create_publisher(String, "status", 10)
        self.create_subscription(Twist, "cmd_vel_in", self.limit, 10)

    def names(self, request, response):
        response.result.names = list(RIGHT)
        return response

    def values(self, request, response):
        self.asked += 1
        response.values = [RIGHT[name] for name in request.names]
        if self.asked > 4:
            response.values = VALUES
        return response

    def set_each(self, request, response):
        response.results = [SetParametersResult(successful=True)] * 500
        return response

    def set_all(self, request, response):
        response.result.successful = True
        return response

    def limit(self, command):
        command.linear.x = min(max(command.linear.x, -1.0), 1.0)
        self.cmd_vel.publish(command)
        self.wheel_speed.publish(Float64(data=command.linear.x / 0.05))

rclpy.init()
rclpy.spin(VelocityLimiter())
"""
_SPIN_BOTH = """
        executor = rclpy.executors.MultiThreadedExecutor()
        executor.add_node(node)
        executor.add_node(other)
        executor.spin()
"""
_DIAMETER = 'self.declare_parameter("wheel_diameter", 0.1, between(0.01, 1.0, "diameter of a wheel, m"))'
_WHEEL = "self.wheel_speed.publish(Float64(data=command.linear.x / radius))"
_LINE = 'self.status.publish(String(data=f"{name}: {highest} m/s"))'


def _by_hand(values: str) -> str:
    return _PARAMETERS_BY_HAND.replace("VALUES", values)


PROGRAMS = {
    "a service whose fields are others": Strange("temperature_service", ("answers", None), source=_OTHER_FIELDS),
    "a service no default client connects to": Strange(
        "temperature_service",
        ("offered", None),
        _made_with("qos_profile=QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)"),
    ),
    "a service that takes itself off the graph": Strange(
        "temperature_service",
        ("answers", "service.wrong_return"),
        _service("        self.destroy_service(self.service)\n"),
    ),
    "two services of one name": Strange(
        "temperature_service",
        ANYTHING,
        (
            (
                "    node = TemperatureService()\n",
                "    node = TemperatureService()\n    other = TemperatureService()\n",
            ),
            ("        rclpy.spin(node)\n", _SPIN_BOTH),
        ),
    ),
    "numbers that are none": Strange(
        "temperature_service",
        ("celsius_to_fahrenheit", "math.formula"),
        _service("        response.success, response.value = True, math.nan\n        return response\n"),
    ),
    "a robot that is nowhere": Strange(
        "move_robot", ("arrives", "action.stops_short"), _result("final_position=Point(x=nan, y=nan)")
    ),
    "feedback without end": Strange(
        "move_robot",
        ("progress", "action.feedback_not_monotonic"),
        (
            (
                "position=self.point(), distance_remaining=remaining, progress=progress",
                "position=Point(x=1e308, y=-1e308), distance_remaining=1e308, progress=1e308",
            ),
        ),
    ),
    "a status that is none": Strange(
        "move_robot", ("succeeds", "action.wrong_terminal"), source=_ACTION_BY_HAND.replace("STATUS", "-128")
    ),
    "values of a type that is none": Strange(
        "robot_parameters", ANYTHING, source=_by_hand("[ParameterValue(type=77) for _ in request.names]")
    ),
    "values of nothing": Strange("robot_parameters", ANYTHING, source=_by_hand("[]")),
    "too many values": Strange("robot_parameters", ANYTHING, source=_by_hand("response.values * 500")),
    "a wheel of no size": Strange(
        "robot_parameters",
        ("defaults", "parameter.default"),
        _limiter(
            (_DIAMETER, 'self.declare_parameter("wheel_diameter", 0.0)'),
            (_WHEEL, "self.wheel_speed.publish(Float64())"),
        ),
    ),
    "a status line of 5 MB": Strange(
        "robot_parameters", ("status", None), ((_LINE, 'self.status.publish(String(data=" " * 5_000_000))'),)
    ),
    "a flood of messages": Strange(
        "robot_parameters", ("status_rate", None), (("STATUS_PERIOD = 0.5", "STATUS_PERIOD = 0.0001"),)
    ),
    "answers within themselves": Strange(
        "pattern_choice", ("known_ids", "quiz.unknown"), source="x = []\nx.append(x)\nanswers = {'a': x, 'b': (x, x)}\n"
    ),
}


pytestmark = [pytest.mark.answers, pytest.mark.timeout(1200)]


@pytest.fixture(scope="module")
def graded(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Report]:
    """All of them, side by side."""
    folder: Path = tmp_path_factory.mktemp("strange")
    with Gradings([load_exercise(name) for name in {one.exercise for one in PROGRAMS.values()}]) as pool:
        requests = []
        for number, (name, program) in enumerate(PROGRAMS.items()):
            path = folder / f"answer_{number}.py"
            path.write_text(program.text())
            submission = ProofSubmission(program.exercise, "strange", name, path)
            requests.append((name, pool.request_for(submission, 3)))
        return dict(pool.grade_all(requests))


@pytest.mark.parametrize("name", PROGRAMS)
def test_it_gets_a_verdict(name: str, graded: dict[str, Report]) -> None:
    report, first = graded[name], PROGRAMS[name].first
    assert report.status in ("graded", "crashed"), report.problem
    if first != ANYTHING:
        assert next((one.id, one.diagnosis) for one in report.checks if one.status == "failed") == first
