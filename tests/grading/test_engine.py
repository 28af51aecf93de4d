"""The one verb: what may be graded, what is refused and how; workers that live and die."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import threading
import time
from dataclasses import asdict
from typing import TYPE_CHECKING

import pytest

from course_kit import environment, grading
from course_kit.grading import engine
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.model.report import CheckResult
from course_kit.grading.workers import exercise_job
from course_kit.process import tree
from tests.grading.conftest import EXERCISE, IDLE, ROOT, processes_of, wait_for_node

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"


@pytest.fixture
def node_running(domain: int) -> Iterator[int]:
    """The solution as a program of its own, not started by the grader, on the graph of ROS_DOMAIN_ID."""
    program = subprocess.Popen(
        [sys.executable, str(SOLUTION)],
        env=environment.child_environment(ROS_DOMAIN_ID=str(domain)),
        stderr=subprocess.DEVNULL,
    )
    wait_for_node("temperature_service", domain)
    yield domain
    program.send_signal(signal.SIGINT)
    program.wait(200)


def test_attach_grades_what_is_on_the_graph(node_running: int) -> None:
    report = grading.grade(EXERCISE, attach=True)
    assert [check.message for check in report.checks if check.status != "passed"] == []
    assert report.score == 10.0
    assert f"domain {node_running}" in report.submission


def test_attach_to_nothing_says_so(domain: int, strict_exercises: Callable[..., Path]) -> None:
    report = grading.grade(EXERCISE, attach=True, exercises=strict_exercises(start_s=1.0))
    assert report.checks[0].diagnosis == "start.nothing"
    assert f"domain {domain}" in report.checks[0].message
    assert grading.exit_code(report) == 1


def test_exec_grades_a_command() -> None:
    command = shlex.join([sys.executable, str(SOLUTION)])
    report = grading.grade(EXERCISE, exec_command=command)
    assert [check.message for check in report.checks if check.status != "passed"] == []
    assert report.submission == command


def test_exec_of_a_program_that_crashes_names_the_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where FORCE_COLOR is set Python 3.13 would colour its traceback, and nobody could read it."""
    monkeypatch.setenv("FORCE_COLOR", "1")
    (tmp_path / "program.py").write_text(
        "import os, rclpy\nprint('colours', os.environ['PYTHON_COLORS'], flush=True)\nrclpy.init()\n1 / 0\n"
    )
    report = grading.grade(EXERCISE, exec_command=shlex.join([sys.executable, str(tmp_path / "program.py")]))
    assert report.checks[0].diagnosis == "start.crash"
    assert "ZeroDivisionError: division by zero" in report.checks[0].message
    assert report.stdout == "colours 0\n"  # on each Python


def test_exactly_one_thing_is_graded() -> None:
    with pytest.raises(grading.GradingError, match="one thing"):
        grading.grade(EXERCISE)
    with pytest.raises(grading.GradingError, match="one thing"):
        grading.grade(EXERCISE, SOLUTION, attach=True)
    for command in ("nosuchcommand --fast", ""):  # nothing is graded: it is no fault of a main()
        with pytest.raises(grading.GradingError, match="no such program"):
            grading.grade(EXERCISE, exec_command=command)


def test_unknown_exercise_is_refused_with_the_known_ones() -> None:
    with pytest.raises(grading.GradingError, match=EXERCISE):
        grading.grade("no_such_exercise", SOLUTION)


def test_unreadable_submission_gets_a_report(tmp_path: Path) -> None:
    report = grading.grade(EXERCISE, tmp_path / "none.py")
    assert (report.status, report.score, report.max_score, report.checks) == ("unreadable", 0.0, 10.0, ())
    assert "There is no file" in report.to_mapping()["stderr"]
    assert grading.exit_code(report) == 2


def test_syntax_error_is_graded_without_running_anything(grade_source: Callable[..., grading.Report]) -> None:
    report = grade_source("print('RUN')\ndef f(:\n    pass\n")
    assert report.status == "crashed"
    assert report.checks[0].diagnosis == "start.syntax"
    assert "In line 2: invalid syntax. The line reads `def f(:`." in report.checks[0].message
    assert "RUN" not in report.stdout
    assert grading.exit_code(report) == 1


def test_ctrl_c_of_a_child_is_what_it_is_everywhere(grade_source: Callable[..., grading.Report]) -> None:
    """The grader's own processes ignore Ctrl-C, and that is inherited."""
    report = grade_source(
        "import signal, subprocess, sys\n"
        "program = 'import time; print(0, flush=True); time.sleep(60)'\n"
        "child = subprocess.Popen([sys.executable, '-c', program], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)\n"
        "child.stdout.readline()\n"
        "child.send_signal(signal.SIGINT)\n"
        "print('ended by', child.wait(), signal.getsignal(signal.SIGINT) is signal.default_int_handler)\n"
    )
    assert report.stdout == f"ended by {-signal.SIGINT} True\n"


def test_field_checks_are_on_whatever_the_user_has_set(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ROS_PYTHON_CHECK_FIELDS", "0")
    path = tmp_path / "a.py"
    path.write_text("import os\nprint(os.environ['ROS_PYTHON_CHECK_FIELDS'])\n")
    assert grading.grade(EXERCISE, path).stdout == "1\n"


def test_a_check_that_breaks_leaves_no_grade() -> None:
    outcomes = {"a": "passed", "b": "error", "c": "skipped"}
    results = [asdict(CheckResult(one, one.upper(), how, 4.0, message=f"about {one}")) for one, how in outcomes.items()]
    outcome = {"results": results, "problem": "", "stdout": "", "stderr": ""}
    report = engine._report(load_exercise(EXERCISE), "shown", outcome, "")
    assert (report.status, report.score, report.passed) == ("error", 0.0, False)
    assert report.problem == 'The grading did not finish: it stopped at the check "B". about b'
    assert grading.exit_code(report) == 2
    assert "Not graded" in grading.render_text(report)


def test_grader_that_breaks_is_not_the_learners_fault(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, solution: str
) -> None:
    (tmp_path / "a.py").write_text(solution)
    (tmp_path / "sabotage").mkdir()
    (tmp_path / "sabotage" / "sitecustomize.py").write_text(
        "import course_kit.graders.temperature_service as t\ndel t.right_value\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "sabotage"))
    report = grading.grade(EXERCISE, tmp_path / "a.py")
    assert report.status == "error"
    assert grading.exit_code(report) == 2
    assert not report.passed


def end_while_grading(worker: grading.Worker, path: Path, end: Callable[[], None]) -> list[int]:
    """Grade a program that never ends, call `end` once it runs; the processes that were at work then."""
    path.write_text("import time\ntime.sleep(600)\n")
    worker.ready()
    below: list[int] = []
    most = IDLE + 4  # grader, entering, init process, program

    def watch() -> None:
        deadline = time.monotonic() + 200
        while len(below) < most and time.monotonic() < deadline:
            below[:] = processes_of(worker)
        end()

    watcher = threading.Thread(target=watch)
    watcher.start()
    with pytest.raises(grading.GradingError, match="ended while it was grading"):
        grading.grade(EXERCISE, path, worker=worker)
    watcher.join()
    assert len(below) >= most
    return below


def all_dead(process_ids: list[int]) -> bool:
    deadline = time.monotonic() + 200
    while time.monotonic() < deadline:
        if tree.measure_usage(process_ids).tasks == 0:
            return True
    return False


def test_grader_that_cannot_be_loaded_is_named(tmp_path: Path, solution: str) -> None:
    (tmp_path / "a.py").write_text(solution)
    folder = tmp_path / "exercises" / "no_grader"
    folder.mkdir(parents=True)
    text = (ROOT / "exercises" / EXERCISE / "exercise.toml").read_text()
    (folder / "exercise.toml").write_text(
        text.replace(EXERCISE, "no_grader", 1).replace(f"graders.{EXERCISE}", "graders.no_grader")
    )
    report = grading.grade("no_grader", tmp_path / "a.py", exercises=tmp_path / "exercises")
    assert report.status == "error"
    assert "course_kit.graders.no_grader" in report.problem


def test_killed_worker_is_told_and_leaves_nothing(tmp_path: Path) -> None:
    with grading.Worker() as worker:
        below = end_while_grading(worker, tmp_path / "a.py", lambda: os.kill(worker.process_id, signal.SIGKILL))
    assert all_dead(below)


def test_closing_ends_what_is_under_way(tmp_path: Path) -> None:
    worker = grading.Worker()
    below = end_while_grading(worker, tmp_path / "a.py", worker.close)
    assert all_dead(below)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("format_version = 1", "format_version"),
        ('id = "temperature_service"', "'id'"),
        ("pass_mark = 7.0", "pass_mark"),
        ("[limits]", "no limit called 'memory'"),
    ],
)
def test_mistake_in_an_exercise_is_named(line: str, said: str, tmp_path: Path) -> None:
    text = (ROOT / "exercises" / EXERCISE / "exercise.toml").read_text()
    folder = tmp_path / EXERCISE
    folder.mkdir()
    replacement = "[limits]\nmemory = 3" if line == "[limits]" else ""
    (folder / "exercise.toml").write_text(text.replace(line + "\n", replacement + "\n"))
    with pytest.raises(
        grading.GradingError, match=f"exercise.toml cannot be used.*{'memory' if replacement else said}"
    ):
        load_exercise(EXERCISE, tmp_path)


def test_points_of_the_checks_are_those_of_the_exercise() -> None:
    exercise = load_exercise(EXERCISE)
    checks = exercise_job.checks_of(exercise, 1)
    assert sum(check.points for check in checks) == exercise.points
    known = {check.id for check in checks}
    for check in known:
        assert exercise.ladder(check), f"the ladder has no rung for {check}"
