"""The exchange a failed check carries: what is kept, what is left out, how it ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from course_interfaces.srv import ConvertTemperature
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import Twist

from course_kit import grading
from course_kit.authoring import corpus
from course_kit.grading.checks.evidence import GRADER, NODE, Evidence, ExchangeLog, in_one_line
from course_kit.ros.sequence import Arrow
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def lines(record: ExchangeLog, evidence: Evidence) -> list[str]:
    return [str(step) for step in record.steps(evidence)]


def test_an_unanswered_request_ends_at_what_came_instead() -> None:
    record = ExchangeLog()
    record.add_sent("request /add: a=1", about="a=1")
    assert lines(record, Evidence("a=1", "sum=2", "no answer within 5 s")) == [
        "grader -> your node: request /add: a=1",
        "your node -> grader, not as expected: no answer within 5 s",
        "expected: sum=2",
    ]


def test_a_long_exchange_says_what_is_left_out() -> None:
    record = ExchangeLog()
    for number in range(10):
        record.add_sent(f"request {number}").add_received(f"response {number}")
    told = lines(record, Evidence(got="x"))
    assert told[0] == "(12 earlier steps left out)"
    assert told[1:3] == ["grader -> your node: request 6", "your node -> grader: response 6"]
    assert len(told) == 9
    record.add_sent("request 10")  # the response to 6 is not shown without its request
    assert lines(record, Evidence())[:2] == told[:2]


def test_what_is_followed_stands_where_it_happened_in_time() -> None:
    record = ExchangeLog()
    turn = record.add_sent("goal")
    turn.further_steps = lambda: [(turn.steps[0][0] + 1e-9, Arrow(NODE, GRADER, "message", "feedback"))]
    record.add_sent("cancel").add_received("nothing came", "failure")
    assert [step.text for step in record.steps(Evidence())] == ["goal", "feedback", "cancel", "nothing came"]


def test_the_next_check_begins_empty_and_tidying_up_is_not_kept() -> None:
    record = ExchangeLog()
    late = record.add_sent("request")
    record.clear()
    late.add_received("too late")
    with record.looking_away():
        record.add_sent("put back")
    assert record.steps(Evidence("", "e", "g")) == ()


def test_messages_are_told_with_their_fields() -> None:
    twist = Twist()
    assert in_one_line(twist) == "all fields 0"
    twist.linear.x = 1.23456
    assert in_one_line(twist) == "linear.x=1.235, the rest 0"
    request = ConvertTemperature.Request(value=98.6, from_unit="x" * 100)
    assert in_one_line(Fibonacci.Result(sequence=[0, 1])) == "sequence=[0, 1]"
    assert in_one_line(request) == f"value=98.6, from_unit='{'x' * 40}...', to_unit=''"


def steps_of(report: grading.Report, check: str) -> list[str]:
    return [str(step) for one in report.checks if one.id == check for step in one.steps]


@pytest.fixture
def grade_wrong(worker: grading.Worker, tmp_path: Path) -> Callable[[str, str], grading.Report]:
    """Grades the submission that is named after a diagnosis."""

    def run(exercise: str, code: str) -> grading.Report:
        wrong = next(one for one in corpus.load_corpus(exercise, ROOT).submissions if one.name == code)
        (tmp_path / "answer.py").write_text(wrong.texts()[wrong.path.name])
        return grading.grade(exercise, tmp_path / "answer.py", worker=worker, seed=3)

    return run


@pytest.mark.parametrize(
    ("exercise", "code", "check", "told"),
    [
        (
            "temperature_service",
            "service.no_return",
            "answers",
            [
                "grader -> your node: request /convert_temperature: value=",
                "your node -> grader, not as expected: no answer: the program ended",
                "expected: an answer",
            ],
        ),
        (
            "move_robot",
            "action.cancel_refused",
            "cancel",
            [
                "goal for /move_robot: ",
                "accepted",
                "request to cancel the goal",
                "your node -> grader: cancelling refused",
            ],
        ),
    ],
)
def test_a_failed_check_carries_its_exchange(
    exercise: str, code: str, check: str, told: list[str], grade_wrong: Callable[[str, str], grading.Report]
) -> None:
    report = grade_wrong(exercise, code)
    steps = steps_of(report, check)
    for words in told:
        assert any(words in line for line in steps), steps
    assert all(not one.steps for one in report.checks if one.status != "failed")
    assert '"steps"' not in report.to_json()
