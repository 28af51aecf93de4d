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
pytestmark = [pytest.mark.answers, pytest.mark.timeout(300)]


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
NO_UTF_8 = r'self.status.publish(b"\0\1\0\0" b"\5\0\0\0" b"\xff\xfe\xff\xfe\0")'
NO_MESSAGE = r'self.status.publish(b"\0\1\0\0\xff\xff\xff\x7f")'


def test_a_status_line_that_is_no_text_costs_the_points_for_the_status(grade: Callable[..., grading.Report]) -> None:
    report = grade(LIMITER, changed(LIMITER, (TELL, NO_UTF_8)))
    assert failed(report) == {"status"}
    check = next(one for one in report.checks if one.id == "status")
    assert "of the form" in check.message or "have the form" in check.message


def test_a_status_line_that_is_no_message_is_none(grade: Callable[..., grading.Report]) -> None:
    report = grade(LIMITER, changed(LIMITER, (TELL, NO_MESSAGE)))
    assert failed(report) == {"status"}
    assert {check.diagnosis for check in report.checks if check.status == "failed"} == {"topic.silent"}


def test_long_names_and_reasons_of_parameters(grade: Callable[..., grading.Report]) -> None:
    changes = (
        ('"default_robot")', '"default_robot" * 600_000)'),
        ('reason="robot_name must not be empty"', 'reason="robot_name must not be empty" * 200_000'),
    )
    assert {"defaults", "status"} <= failed(grade(LIMITER, changed(LIMITER, *changes)))


ANSWERED = "        response.success = not response.message\n"


def test_service_answers_of_8_mb(grade: Callable[..., grading.Report]) -> None:
    """What a slow machine makes of them is another matter: they may come too late."""
    long = '        response.success = True\n        response.message = "x" * (8 << 20)\n'
    report = grade(SERVICE, changed(SERVICE, (ANSWERED, long)))
    passed = {check.id for check in report.checks if check.status == "passed"}
    assert {"offered", "node_name"} <= passed
    assert "unknown_unit" not in passed


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
    "two thousand entries that look alike": f"answers = {{{', '.join(f'weld_seam{n}: 1' for n in range(2000))}}}",
    "one of 1 MB": f'answers = {{"weld_seam": "{"a" * 1_000_000}"}}',
    "worked out": 'answers = dict([("weld_seam", ("\\ud800", 10**6000)), ("x" * 5000, 2), (10**5000, 3), ((), [])])',
    "a sum": f'answers = {{"weld_seam": {"1+" * 900}1}}',
}


@pytest.mark.parametrize("what", ANSWERS)
def test_answers_nobody_would_write(what: str, grade: Callable[..., grading.Report]) -> None:
    report = grade(CHOICE, ANSWERS[what])
    assert report.score == 0.0
    report.to_json().encode()  # half a character could not be written
