"""A declared check waits no more often than the same check in Python does."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment
from course_kit.graders import robot_parameters, temperature_service
from course_kit.grading.checks.check import Check, run_all
from course_kit.grading.checks.context import CheckContext
from course_kit.grading.checks.declared import building
from course_kit.grading.checks.declared.around import Around
from course_kit.grading.checks.declared.declaration import Declaration, WantedEndpoint
from course_kit.grading.job import Job
from course_kit.grading.limits import Limits
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

pytestmark = pytest.mark.answers
START_S = 60.0  # against hanging only
CONVERT = {"service": WantedEndpoint("service", "/convert_temperature", "course_interfaces/srv/ConvertTemperature")}
TOPICS = {
    "subscription": WantedEndpoint("subscription", "/cmd_vel_in", "geometry_msgs/msg/Twist"),
    "publisher": WantedEndpoint("publisher", "/cmd_vel", "geometry_msgs/msg/Twist"),
}
TO_FAHRENHEIT = {"from_unit": "celsius", "to_unit": "fahrenheit"}
NODE = "/velocity_limiter"


def declared(name: str, kind: str, endpoints: dict[str, WantedEndpoint], **keys: Any) -> Declaration:
    return Declaration(name, kind, name, 1.0, 20.0, endpoints=endpoints, node=NODE, keys=keys)


TEMPERATURE = (
    declared("offered", "offered", CONVERT),
    declared(
        "converts",
        "answers",
        CONVERT,
        requests=[{"value": {"draw": [-200.0, 500.0], "count": 6}, **TO_FAHRENHEIT}],
        expect={"success": True, "value": "request.value * 9 / 5 + 32"},
    ),
)
LIMITER = (
    declared("offered", "offered", TOPICS),
    declared("declared", "parameter_declared", {}, parameter="max_velocity", default=1.0),
    declared(
        "limits",
        "topic_answers",
        TOPICS,
        messages=[{"linear": {"x": x}} for x in (0.5, -0.5, 9.0, -9.0)],
        expect={"linear": {"x": "clamp(message.linear.x, -parameters.max_velocity, parameters.max_velocity)"}},
    ),
)


class CountingContext(CheckContext):
    """Counts how often it is waited for something."""

    waits = 0

    def wait_until(self, *arguments: Any, **options: Any) -> bool:
        """See `CheckContext`."""
        self.waits += 1
        return super().wait_until(*arguments, **options)


@pytest.fixture
def node(domain: int, request: pytest.FixtureRequest) -> Iterator[None]:
    name = request.param
    environ = environment.child_environment(ROS_DOMAIN_ID=str(domain))
    with subprocess.Popen([sys.executable, ROOT / "solutions" / name / f"{name}.py"], env=environ) as program:
        yield
        program.kill()


def waits(checks: Sequence[Check]) -> int:
    job = Job("", "attach", "", 3, limits=Limits(start_s=START_S))
    context = CountingContext(None, job)  # type: ignore[arg-type] # nobody starts anything
    context.launch()
    try:
        node = context.grader_node
        assert context.wait_until(lambda: bool(node.services() or node.publishers("/status")), START_S)
        context.waits = 0
        found = list(run_all(checks, context))
    finally:
        context.close()
    assert [(one.id, one.status, one.message) for one in found if one.status != "passed"] == []
    return context.waits


@pytest.mark.usefixtures("node")
@pytest.mark.parametrize(
    ("node", "declarations", "python"),
    [
        (
            "temperature_service",
            TEMPERATURE,
            # The first is the same; the third asks once, so that both ask six times.
            (TEMPERATURE[0], temperature_service.celsius_to_fahrenheit, temperature_service.answers),
        ),
        (
            "robot_parameters",
            LIMITER,
            (robot_parameters.node_up, *LIMITER[:2], robot_parameters.limits),
        ),
    ],
    ids=["temperature_service", "robot_parameters"],
    indirect=["node"],
)
def test_a_declared_check_waits_no_more_often(
    declarations: Sequence[Declaration], python: Sequence[Check | Declaration]
) -> None:
    made = [building.checks_of(Around([one]))[0] if isinstance(one, Declaration) else one for one in python]
    alone = [Check(one.id, one.title, one.points, (), 20.0, one.run) for one in made]
    assert waits(building.checks_of(Around(declarations))) <= waits(alone)
