"""One wrong submission for each diagnosis: it gets exactly that code."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.grading.diagnosis import catalogue
from tests.robot_parameters.conftest import EXERCISE, ROOT, Reports

if TYPE_CHECKING:
    from pathlib import Path

BROKEN = sorted((ROOT / "tests" / "broken" / EXERCISE).glob("*.py"))
FACTS = {
    "field.type": "The field 'x' must be a float, and something else was put into it in line",
    "math.formula": "This is the speed divided by the diameter",
    "math.integer_division": "Digits were lost",
    "name.node": "The closest is /velocity_limit.",
    "parameter.bad_callback": "ValueError: robot_name must not be empty in line 38: raise ValueError(reason)",
    "parameter.default": "wheel_diameter=0.2",
    "parameter.not_atomic": "yet your node acts on it",
    "parameter.override_ignored": "the node acts on another",
    "parameter.read_once": "what comes out is the same as before",
    "parameter.type": "max_velocity is integer",
    "parameter.undeclared": "has not declared enabled",
    "start.crash": "KeyError: 'right' in line",
    "start.import": "The nearest name there is: Float",
    "start.nothing": "the class VelocityLimiter, which is no rclpy Node",
    "topic.qos": "Best effort publisher and reliable subscription",
    "topic.silent": "The closest is /velocity_limiter/wheel_speed",
    "type.interface": "std_msgs/msg/Float32 instead of std_msgs/msg/Float64",
    "validation.missing": "Your node accepted robot_name=''",
    "validation.no_reason": "It is empty.",
    "validation.overzealous": "refused max_velocity=",
}


@pytest.mark.parametrize("program", BROKEN, ids=lambda path: path.stem)
def test_broken_submission_gets_exactly_its_code(program: Path, reports: Reports) -> None:
    report = reports.of(program)
    failed = [check for check in report.checks if check.status in ("failed", "error")]
    assert {check.diagnosis for check in failed} == {program.stem}
    assert report.score < report.max_score
    for check in failed:
        assert check.expected
        assert check.got
        assert check.hint
        assert catalogue()[program.stem].explanation in check.message
    assert FACTS.get(program.stem, "").lower() in " ".join(check.message for check in failed).lower()


def test_every_code_of_parameters_and_topics_has_its_broken_submission() -> None:
    codes = {code for code in catalogue() if code.startswith(("parameter.", "topic.", "start.", "limit."))}
    assert codes <= {path.stem for path in BROKEN}
