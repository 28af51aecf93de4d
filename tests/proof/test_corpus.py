"""All that `course-kit dev check` wants holds of every exercise and drill, each verdict is the frozen one, and the
messages name the facts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import corpus, rules
from course_kit.grading.model.catalogue import catalogue
from course_kit.grading.model.exercise import load_exercise
from tests.proof.conftest import CONVERSATIONS, DRILLS, EXERCISES, ROOT, SAMPLE, is_compared_in_short

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.authoring.corpus import ProofSubmission
    from course_kit.grading import Report
    from tests.proof.conftest import Proofs

pytestmark = [pytest.mark.answers, pytest.mark.timeout(1200)]  # the first test grades the submissions
# What any program can do wrong is tried in exercise 1, and what is quick in the one without a node.
NOT_OF_SERVICES = ("action.", "parameter.", "topic.", "quiz.", "name.action")
OF_ACTIONS = ("start.exit", "action.", "name.action", "name.node", "type.", "field.", "validation.overzealous")
OF_PARAMETERS = ("start.exit", "parameter.", "topic.")
OF_PATTERNS = ("start.syntax", "start.import", "start.crash", "start.exit", "limit.time", "quiz.")
FACTS = [
    ("temperature_service", "start.syntax", "the line reads `def main()`"),
    ("temperature_service", "start.import", "The nearest name is course_interfaces"),
    ("temperature_service", "start.crash", "The error: KeyError: 'kelvin'"),
    ("temperature_service", "start.nothing", "the class TemperatureService, which is not an rclpy Node"),
    ("temperature_service", "start.exit", "exit code 0"),
    ("temperature_service", "name.service", "The closest is /convert_temperatur"),
    ("temperature_service", "name.node", "/temperature_server"),
    (
        "temperature_service",
        "type.interface",
        "std_srvs/srv/SetBool, expected course_interfaces/srv/ConvertTemperature",
    ),
    ("temperature_service", "service.wrong_return", "an object of type float"),
    ("temperature_service", "service.exception", "KeyError: 'fahrenheit' in line 17"),
    ("temperature_service", "service.deadlock", "self.client.call("),
    ("temperature_service", "field.type", "field 'value' must be a float"),
    ("temperature_service", "math.formula", "multiplication goes before subtraction"),
    ("temperature_service", "limit.memory", "256 MB"),
    ("robot_parameters", "math.formula", "This is the speed divided by the diameter"),
    ("robot_parameters", "name.node", "The closest is /velocity_limit."),
    ("robot_parameters", "parameter.bad_callback", "in line 38: raise ValueError(reason)"),
    ("robot_parameters", "parameter.default", "wheel_diameter=0.2"),
    ("robot_parameters", "parameter.not_atomic", "since your node refused an invalid change"),
    ("robot_parameters", "parameter.override_ignored", "the node acts on another"),
    ("robot_parameters", "parameter.read_once", "is the same as before"),
    ("robot_parameters", "parameter.type", "max_velocity is integer"),
    ("robot_parameters", "parameter.undeclared", "has not declared enabled"),
    ("robot_parameters", "topic.qos", "Best effort publisher and reliable subscription"),
    ("robot_parameters", "topic.silent", "The closest is /velocity_limiter/wheel_speed"),
    ("robot_parameters", "validation.missing", "Your node accepted"),
    ("robot_parameters", "validation.no_reason", "It is empty."),
    ("pattern_choice", "limit.time", "It may compute for 3 s"),
    ("pattern_choice", "quiz.malformed", "Without quotes, Python reads"),
    ("pattern_choice", "quiz.unknown", "did you mean"),
]
SYMPTOMS = {  # the words in which an untouched drill is told the cause
    "empty_dashboard": "Best effort publisher and reliable subscription",
    "deaf_to_cancel": "did not answer the request to cancel before the goal was over",
    "stuck_call": "self.adder.call(request)",
    "stubborn_limit": "the output is the same as before",
    "long_queue": "the last of 8 requests that are sent together waits",
    "dark_lamp": "/brightness with type std_msgs/msg/Float32, expected std_msgs/msg/Float64",
    "two_at_once": "accepted a second goal while the first was running",
    "good_but_aborted": "returned without saying how the goal ended",
}
VERDICTS = ROOT / "tests" / "frozen" / "verdicts.txt"
LONGEST_GRADER = 60  # lines, in TOML and in Python together


def shown(one: ProofSubmission, report: Report) -> str:
    """A verdict in one line: what has not passed, by name."""
    if is_compared_in_short(one):
        marks = "full marks" if report.score == report.max_score else "less than full marks"
        return f"{named(one)}: {report.status}, {marks}"
    passed = sum(check.status == "passed" for check in report.checks)
    others = [
        f"{check.id} {check.status}{f' ({check.diagnosis})' * bool(check.diagnosis)}"
        for check in report.checks
        if check.status != "passed"
    ]
    return "; ".join([f"{named(one)}: {report.status}, {report.score:g} points, {passed} passed", *others])


def named(one: ProofSubmission) -> str:
    return f"{one.exercise} {one.kind} {one.name}"


def test_each_submission_gets_the_verdict_that_is_frozen(proofs: Proofs, frozen: Callable[..., None]) -> None:
    """The same with each seed; of what is not in the sample there is one."""
    kept = dict(line.split(": ", 1) for line in VERDICTS.read_text(encoding="utf-8").splitlines())
    verdicts = {
        one: shown(one, proofs.reports[one]) if one in proofs.reports else f"{named(one)}: {kept.get(named(one))}"
        for each in proofs.sets
        for one in each.submissions
    }
    frozen(VERDICTS.name, "".join(sorted(f"{verdict}\n" for verdict in verdicts.values())))


def test_everything_holds(proofs: Proofs, request: pytest.FixtureRequest) -> None:
    sampled = request.node.callspec.params["proofs"] == SAMPLE
    faults = [str(fault) for fault in proofs.faults]
    assert [fault for fault in faults if not (sampled and fault.startswith(CONVERSATIONS))] == []
    for one, report in proofs.reports.items():
        if one.kind in ("solution", "variant"):
            assert report.score == load_exercise(one.exercise).points
        elif one.exercise in DRILLS:
            assert report.passed == (one.kind == "slip" and not one.failed), one.name


def names(exercise: str) -> set[str]:
    """Of the submissions that are named after a diagnosis."""
    return {one.name for one in corpus.load_corpus(exercise, ROOT).submissions} & set(catalogue())


def test_every_code_has_a_broken_submission() -> None:
    assert rules.codes_without_submission({name for exercise in EXERCISES for name in names(exercise)}) == []


def test_every_code_that_an_exercise_can_give_has_a_broken_submission_there() -> None:
    codes = set(catalogue())
    assert names("temperature_service") == {code for code in codes if not code.startswith(NOT_OF_SERVICES)}
    assert names("move_robot") == {code for code in codes if code.startswith(OF_ACTIONS)}
    assert names("robot_parameters") >= {code for code in codes if code.startswith(OF_PARAMETERS)}
    assert names("pattern_choice") == {code for code in codes if code.startswith(OF_PATTERNS)}


@pytest.mark.parametrize(("exercise", "code", "fact"), FACTS)
def test_message_names_the_fact(exercise: str, code: str, fact: str, proofs: Proofs) -> None:
    failed = [check for check in proofs.of(exercise, code).checks if check.status == "failed"]
    assert fact.lower() in " ".join(check.message for check in failed).lower()


def test_each_drill_names_the_cause_of_its_symptom(proofs: Proofs) -> None:
    for drill, said in SYMPTOMS.items():
        report = proofs.of(drill, f"{drill}.ipynb", "starter")
        [failed] = [one for one in report.checks if one.status == "failed"]
        assert said in failed.message


def test_there_are_eight() -> None:
    assert sorted(SYMPTOMS) == DRILLS
    exercises = [load_exercise(drill, ROOT / "exercises") for drill in DRILLS]
    assert sorted(exercise.order for exercise in exercises) == list(range(1, 9))
    assert all(one.practice and one.symptom and one.pass_mark == one.points for one in exercises)


def test_drills_have_other_repairs_other_wrong_repairs_and_short_graders() -> None:
    for drill in DRILLS:
        slips = corpus.load_corpus(drill, ROOT).of_kind("slip")
        assert len([one for one in slips if not one.failed]) >= 2
        assert len([one for one in slips if one.failed]) >= 5
        assert 0 < grader_lines(drill) <= LONGEST_GRADER


def grader_lines(drill: str) -> int:
    folder = load_exercise(drill, ROOT / "exercises").folder
    counted, inside = 0, False
    for line in (folder / "exercise.toml").read_text().splitlines():
        inside = line in ("[[checks]]", "[[endpoints]]") if line.startswith("[") else inside
        counted += inside and bool(line.strip())
    python = [line for path in folder.glob("*.py") if path.stem != drill for line in path.read_text().splitlines()]
    return counted + len(python)
