"""All that `course-kit dev check` wants holds of every exercise; and the messages name the facts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from course_kit.authoring import corpus, rules, sentences
from course_kit.grading import exercise as course
from course_kit.grading.diagnosis.catalogue import catalogue
from tests.proof.conftest import EXERCISES, ROOT

if TYPE_CHECKING:
    from tests.proof.conftest import Proofs

SENTENCES = ROOT / "artifacts" / "sentences.md"
pytestmark = pytest.mark.timeout(1200)  # the first test grades all submissions of all exercises
OF_PATTERNS = ("start.syntax", "start.import", "start.crash", "start.exit", "limit.", "quiz.")
NOT_OF_SERVICES = ("action.", "parameter.", "topic.", "quiz.", "name.action")
OF_ACTIONS = ("start.", "limit.", "action.", "name.action", "name.node", "type.", "field.", "validation.overzealous")
OF_PARAMETERS = ("start.", "limit.", "parameter.", "topic.")
STARTERS = {  # the check that fails first, its diagnosis, and what its hint says
    "temperature_service": ("answers", None, "empty response to fill in"),
    "move_robot": ("succeeds", "action.no_terminal", "Begin with the drive alone"),
    "robot_parameters": ("declared", "parameter.undeclared", "declare_parameter(name, default)"),
    "pattern_choice": (None, "quiz.missing", "Begin with the easiest"),
}
ONLY = {  # broken submissions of exercise 2 that fail one check alone
    "name.action": "offered",
    "name.node": "node_name",
    "action.accepts_impossible": "not_a_number",
    "action.no_feedback": "feedback",
}
FACTS = [
    ("temperature_service", "start.syntax", "line 36: def main()"),
    ("temperature_service", "start.import", "The nearest name is course_interfaces"),
    ("temperature_service", "start.crash", "KeyError: 'kelvin' in line 13"),
    ("temperature_service", "start.nothing", "the class TemperatureService, which is not an rclpy Node"),
    ("temperature_service", "start.exit", "exit code 0"),
    ("temperature_service", "name.service", "The closest is /convert_temperatur"),
    ("temperature_service", "name.node", "/temperature_server"),
    (
        "temperature_service",
        "type.interface",
        "has type std_srvs/srv/SetBool, expected course_interfaces/srv/ConvertTemperature",
    ),
    ("temperature_service", "service.wrong_return", "an object of type float"),
    ("temperature_service", "service.exception", "KeyError: 'fahrenheit' in line 17"),
    ("temperature_service", "service.deadlock", "self.client.call("),
    ("temperature_service", "field.type", "field 'value' must be a float"),
    ("temperature_service", "math.formula", "multiplication goes before subtraction"),
    ("temperature_service", "limit.memory", "256 MB"),
    ("robot_parameters", "field.type", "The field 'x' must be a float, but something else was put into it in line"),
    ("robot_parameters", "math.formula", "This is the speed divided by the diameter"),
    ("robot_parameters", "math.integer_division", "Digits were lost"),
    ("robot_parameters", "name.node", "The closest is /velocity_limit."),
    (
        "robot_parameters",
        "parameter.bad_callback",
        "ValueError: robot_name must not be empty in line 38: raise ValueError(reason)",
    ),
    ("robot_parameters", "parameter.default", "wheel_diameter=0.2"),
    ("robot_parameters", "parameter.not_atomic", "yet it acts on it"),
    ("robot_parameters", "parameter.override_ignored", "the node acts on another"),
    ("robot_parameters", "parameter.read_once", "what comes out is the same as before"),
    ("robot_parameters", "parameter.type", "max_velocity is integer"),
    ("robot_parameters", "parameter.undeclared", "has not declared enabled"),
    ("robot_parameters", "start.crash", "KeyError: 'right' in line"),
    ("robot_parameters", "start.import", "The nearest name is Float"),
    ("robot_parameters", "start.nothing", "the class VelocityLimiter, which is not an rclpy Node"),
    ("robot_parameters", "topic.qos", "Best effort publisher and reliable subscription"),
    ("robot_parameters", "topic.silent", "The closest is /velocity_limiter/wheel_speed"),
    ("robot_parameters", "type.interface", "with type std_msgs/msg/Float32, expected std_msgs/msg/Float64"),
    ("robot_parameters", "validation.missing", "Your node accepted robot_name=''"),
    ("robot_parameters", "validation.no_reason", "It is empty."),
    ("robot_parameters", "validation.overzealous", "refused max_velocity="),
    ("pattern_choice", "start.syntax", "in line 2"),
    ("pattern_choice", "start.import", "The nearest name is course_kit"),
    ("pattern_choice", "start.crash", "in line 3"),
    ("pattern_choice", "start.exit", "exit code 0"),
    ("pattern_choice", "limit.time", "used the processor for 3 s"),
    ("pattern_choice", "limit.memory", "256 MB"),
    ("pattern_choice", "quiz.malformed", "Without quotes, Python takes"),
    ("pattern_choice", "quiz.unknown", "did you mean"),
]


@pytest.mark.parametrize("exercise", EXERCISES)
def test_everything_holds(exercise: str, proofs: Proofs) -> None:
    assert [str(fault) for fault in proofs.of(exercise).faults] == []
    for one, report in proofs.of(exercise).runs[0].reports.items():
        if one.kind in ("solution", "variant"):
            assert report.score == course.load(exercise).points


def names(exercise: str) -> set[str]:
    return {one.name for one in corpus.load(exercise, ROOT).of("broken")}


def test_every_code_has_a_broken_submission() -> None:
    assert rules.codes_without_submission({name for exercise in EXERCISES for name in names(exercise)}) == []


def test_every_code_that_an_exercise_can_give_has_a_broken_submission_there() -> None:
    codes = set(catalogue())
    assert names("temperature_service") == {code for code in codes if not code.startswith(NOT_OF_SERVICES)}
    assert names("move_robot") == {code for code in codes if code.startswith(OF_ACTIONS)}
    assert names("robot_parameters") >= {code for code in codes if code.startswith(OF_PARAMETERS)}
    assert names("pattern_choice") == {code for code in codes if code.startswith(OF_PATTERNS)}


@pytest.mark.parametrize("exercise", EXERCISES)
def test_starter_fails_with_a_useful_first_hint(exercise: str, proofs: Proofs) -> None:
    report = proofs.report(exercise, "starter", f"{exercise}.py")
    first = next(check for check in report.checks if check.status == "failed")
    check_id, code, said = STARTERS[exercise]
    assert grading.exit_code(report) == 1
    assert (first.id, first.diagnosis) == (check_id or first.id, code)
    assert said in str(first.hint)


def test_starter_of_exercise_3_is_told_what_is_missing(proofs: Proofs) -> None:
    report = proofs.report("robot_parameters", "starter", "robot_parameters.py")
    first = next(check for check in report.checks if check.status == "failed")
    assert "robot_name, max_velocity, wheel_diameter, enabled" in first.message


@pytest.mark.parametrize(("exercise", "code", "fact"), FACTS)
def test_message_names_the_fact(exercise: str, code: str, fact: str, proofs: Proofs) -> None:
    failed = [check for check in proofs.report(exercise, "broken", code).checks if check.status == "failed"]
    assert fact.lower() in " ".join(check.message for check in failed).lower()


@pytest.mark.parametrize(("code", "check_id"), ONLY.items())
def test_broken_move_fails_where_it_is_broken(code: str, check_id: str, proofs: Proofs) -> None:
    report = proofs.report("move_robot", "broken", code)
    assert [check.id for check in report.checks if check.status == "failed"] == [check_id]


def test_each_sentence_of_a_task_is_turned_red_by_a_submission(proofs: Proofs) -> None:
    """And the table of that is written: sentence, checks, submissions."""
    tables = []
    for exercise in EXERCISES:
        found = proofs.of(exercise)
        sets, reports = found.sets[0], found.runs[0].reports
        assert list(sentences.unproven(sets, reports)) == []
        tables.append(sentences.table(sets.task, sentences.proven(sets, reports)))
    SENTENCES.parent.mkdir(exist_ok=True)
    SENTENCES.write_text("\n\n".join(["# Each sentence of a task, and what turns it red", *tables]) + "\n")
    rows = [line for line in SENTENCES.read_text().splitlines() if line.startswith("| **")]
    assert len(rows) == sum(len(proofs.of(exercise).sets[0].task.sentences) for exercise in EXERCISES)
