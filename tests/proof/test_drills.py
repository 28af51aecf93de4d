"""Every drill: its broken program shows its symptom by name, repairs are done, and what only silences it is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import check, corpus, sentences
from course_kit.grading import exercise, exercise_folders
from tests.proof.conftest import ROOT

if TYPE_CHECKING:
    from course_kit import grading

pytestmark = [pytest.mark.answers, pytest.mark.timeout(600)]  # the first test grades all submissions
DRILLS = sorted(exercise_folders.drills(ROOT / "exercises"))
SYMPTOMS = {  # what an untouched drill is told, and in which words the fact is named
    "empty_dashboard": ("topic.qos", "Best effort publisher and reliable subscription"),
    "deaf_to_cancel": ("action.cancel_blocked", "did not answer the request to cancel before the goal was over"),
    "stuck_call": ("service.deadlock", "self.adder.call(request)"),
    "stubborn_limit": ("parameter.read_once", "what comes out is the same as before"),
    "long_queue": ("service.blocks", "the last of 8 clients that ask together waits"),
    "dark_lamp": ("type.interface", "/brightness with type std_msgs/msg/Float32, expected std_msgs/msg/Float64"),
    "two_at_once": ("action.concurrent_goals", "accepted a second goal while the first was running"),
    "good_but_aborted": ("action.no_terminal", "returned without saying how the goal ended"),
}
LONGEST_GRADER = 60  # lines, in TOML and in Python together


@pytest.fixture(scope="module")
def outcome() -> check.ProofOutcome:
    return check.check(ROOT, DRILLS)


def own_starters(drill: str, outcome: check.ProofOutcome) -> list[grading.Report]:
    reports = outcome.runs[0].reports
    return [report for one, report in reports.items() if (one.exercise, one.kind) == (drill, "starter")]


def test_there_are_eight() -> None:
    assert sorted(SYMPTOMS) == DRILLS
    tasks = [exercise.load(drill, ROOT / "exercises") for drill in DRILLS]
    assert sorted(task.order for task in tasks) == list(range(1, 9))
    assert all(task.practice and task.symptom and task.pass_mark == task.points for task in tasks)


@pytest.mark.parametrize("drill", DRILLS)
def test_everything_holds(drill: str, outcome: check.ProofOutcome) -> None:
    assert [str(fault) for fault in outcome.faults if fault.exercise == drill] == []
    for one, report in outcome.runs[0].reports.items():
        if one.exercise == drill:
            assert report.passed == (one.kind == "solution" or (one.kind == "slip" and not one.failed)), one.name


@pytest.mark.parametrize("drill", DRILLS)
def test_the_broken_program_fails_one_check_whose_diagnosis_names_the_cause(
    drill: str, outcome: check.ProofOutcome
) -> None:
    code, said = SYMPTOMS[drill]
    program, notebook = own_starters(drill, outcome)
    for report in (program, notebook):
        failed = [one for one in report.checks if one.status == "failed"]
        assert [one.diagnosis for one in failed] == [code]
        assert said in failed[0].message


@pytest.mark.parametrize("drill", DRILLS)
def test_there_are_other_repairs_and_other_wrong_repairs(drill: str) -> None:
    slips = corpus.load(drill, ROOT).of("slip")
    assert len([one for one in slips if not one.failed]) >= 2
    assert len([one for one in slips if one.failed]) >= 5


@pytest.mark.parametrize("drill", DRILLS)
def test_its_grader_is_short(drill: str) -> None:
    folder = exercise.load(drill, ROOT / "exercises").folder
    counted, inside = 0, False
    for line in (folder / "exercise.toml").read_text().splitlines():
        inside = line in ("[[checks]]", "[[endpoints]]") if line.startswith("[") else inside
        counted += inside and bool(line.strip())
    python = [line for path in folder.glob("*.py") if path.stem != drill for line in path.read_text().splitlines()]
    assert 0 < counted + len(python) <= LONGEST_GRADER


def test_each_sentence_of_a_drill_is_turned_red(outcome: check.ProofOutcome) -> None:
    reports = outcome.runs[0].reports
    assert [text for sets in outcome.sets for text in sentences.unproven(sets, reports)] == []
