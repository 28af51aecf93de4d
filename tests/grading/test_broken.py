"""One wrong submission for each diagnosis: it gets exactly that code."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from course_kit.grading.diagnosis import catalogue
from tests.grading.conftest import EXERCISE, ROOT

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.timeout(300)  # the first test grades all of them
BROKEN = sorted((ROOT / "tests" / "broken" / EXERCISE).glob("*.py"))
OF_OTHER_EXERCISES = ("action.", "parameter.", "topic.", "quiz.", "name.action")


@pytest.fixture(scope="module")
def reports(worker: grading.Worker) -> dict[str, grading.Report]:
    return {path.stem: grading.grade(EXERCISE, path, worker=worker) for path in BROKEN}


@pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)
def test_broken_submission_gets_exactly_its_code(path: Path, reports: dict[str, grading.Report]) -> None:
    report = reports[path.stem]
    failed = [check for check in report.checks if check.status == "failed"]
    assert failed
    assert {check.diagnosis for check in failed} == {path.stem}
    assert not any(check.status == "error" for check in report.checks)
    assert report.score < report.max_score
    for check in failed:
        assert check.expected
        assert check.got
        assert check.hint
        assert catalogue()[path.stem].link in check.message


def test_every_code_of_services_has_its_broken_submission() -> None:
    codes = {code for code in catalogue() if not code.startswith(OF_OTHER_EXERCISES)}
    assert {path.stem for path in BROKEN} == codes


def messages(report: grading.Report) -> str:
    return " ".join(check.message for check in report.checks if check.status == "failed")


@pytest.mark.parametrize(
    ("code", "fact"),
    [
        ("start.syntax", "line 36: def main()"),
        ("start.import", "The nearest name there is: course_interfaces"),
        ("start.crash", "KeyError: 'kelvin' in line 13"),
        ("start.nothing", "the class TemperatureService, which is no rclpy Node"),
        ("start.exit", "exit code 0"),
        ("name.service", "The closest is /convert_temperatur"),
        ("name.node", "/temperature_server"),
        ("type.interface", "std_srvs/srv/SetBool instead of course_interfaces/srv/ConvertTemperature"),
        ("service.wrong_return", "an object of type float"),
        ("service.exception", "KeyError: 'fahrenheit' in line 17"),
        ("service.deadlock", "self.client.call("),
        ("field.type", "field 'value' must be a float"),
        ("math.formula", "multiplication goes before subtraction"),
        ("limit.memory", "512 MB"),
    ],
)
def test_message_names_the_fact(code: str, fact: str, reports: dict[str, grading.Report]) -> None:
    assert fact in messages(reports[code])
