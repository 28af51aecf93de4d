"""Exercise 2: what is right gets full marks in any style, what is wrong is told what it is.

The gradings run side by side on a few workers, most of their time is the robot's.
"""

from __future__ import annotations

import json
import multiprocessing
import shlex
import signal
import subprocess
import sys
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit import environment, grading
from course_kit.grading import submission
from course_kit.grading.diagnosis import catalogue
from tests.grading import grade_files
from tests.grading.conftest import ROOT
from tests.grading.moves import FOLDER, SLIPS, Slip

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.timeout(300)  # a test may have to wait for the gradings before its own
EXERCISE = "move_robot"
STARTER = ROOT / "exercises" / EXERCISE / f"{EXERCISE}.py"
NOTEBOOK = STARTER.with_suffix(".ipynb")
SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"
BROKEN = sorted((ROOT / "tests" / "broken" / EXERCISE).glob("*.py"))
CORRECT = sorted(FOLDER.glob("*.py"))
SLOWEST_FIRST = ("own_motion_loop", "feedback_timer")
WORKERS = 6  # more than processors: robots mostly wait
CODES = ("start.", "limit.", "action.", "name.action", "name.node", "type.", "field.", "validation.overzealous")

BY_BROKEN = {  # checks that a broken submission fails, and no slip
    "name.action": "offered",
    "name.node": "node_name",
    "action.accepts_impossible": "not_a_number",
    "action.no_feedback": "feedback",
}

by_stem = pytest.mark.parametrize("path", BROKEN, ids=lambda path: path.stem)


class Gradings:
    """Reports of many submissions, by their files.

    Each is made in one of a few processes. Threads would do, but for Python 3.11: there reading programs (`ast`) in
    two threads at a time can fail in either (python/cpython issue 106905).
    """

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pool = ProcessPoolExecutor(WORKERS, context, initializer=grade_files.prepare)
        self._reports: dict[Path, Future[grading.Report]] = {}

    def begin(self, path: Path) -> None:
        self._reports[path] = self._pool.submit(grade_files.grade, EXERCISE, path)

    def of(self, path: Path) -> grading.Report:
        return self._reports[path].result()

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)


def slip_file(slip: Slip, folder: Path) -> Path:
    path = folder / f"{slip.name.replace(' ', '_').replace(',', '')}.py"
    path.write_text(slip.source())
    return path


def made_files(folder: Path) -> dict[str, Path]:
    """The solution in other guises."""
    text = SOLUTION.read_text()
    imports, middle, rest = text.partition("TOLERANCE =")
    cells = [
        {"cell_type": "markdown", "source": ["# Exercise\n"]},
        {"cell_type": "code", "source": [f"%%submission {EXERCISE}\n", *imports.splitlines(keepends=True)]},
        {"cell_type": "code", "source": f"%%submission {EXERCISE}\n{middle}{rest}"},
    ]
    windows, notebook = folder / "windows.py", folder / "notebook.ipynb"
    windows.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    notebook.write_text(json.dumps({"cells": cells}))
    return {"windows": windows, "notebook": notebook, "solution": SOLUTION}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("moves")


@pytest.fixture(scope="module")
def gradings(folder: Path, request: pytest.FixtureRequest) -> Iterator[Gradings]:
    """The gradings that the chosen tests of this module want, all begun."""
    chosen = {item.name for item in request.session.items if item.path == Path(__file__)}
    paths = [*CORRECT, STARTER, NOTEBOOK, *BROKEN, *made_files(folder).values()]
    paths += [slip_file(slip, folder) for slip in SLIPS]
    running = Gradings()
    for path in sorted(paths, key=lambda path: path.stem not in SLOWEST_FIRST):
        if len(chosen) > 1 or any(path.stem in name.replace(" ", "_") for name in chosen) or path == STARTER:
            running.begin(path)
    yield running
    running.close()


def failures(report: grading.Report) -> list[tuple[str, str, str]]:
    return [(check.id, check.status, check.message) for check in report.checks if check.status != "passed"]


@pytest.mark.parametrize("path", CORRECT, ids=lambda path: path.stem)
def test_correct_program_gets_full_marks(path: Path, gradings: Gradings) -> None:
    report = gradings.of(path)
    assert failures(report) == []
    assert (report.status, report.score, report.passed) == ("graded", 20.0, True)


@pytest.mark.parametrize("guise", ["solution", "windows", "notebook"])
def test_solution_in_any_file_gets_full_marks(guise: str, gradings: Gradings, folder: Path) -> None:
    assert failures(gradings.of(made_files(folder)[guise])) == []


def test_there_are_at_least_eight_styles() -> None:
    assert len(CORRECT) >= 8


@by_stem
def test_broken_submission_gets_exactly_its_code(path: Path, gradings: Gradings) -> None:
    report = gradings.of(path)
    failed = [check for check in report.checks if check.status == "failed"]
    assert failed
    assert {check.diagnosis for check in failed} == {path.stem}
    assert not any(check.status == "error" for check in report.checks)
    assert report.score < report.max_score
    for check in failed:
        assert check.expected
        assert check.got
        assert check.hint
        assert catalogue()[path.stem].explanation in check.message


def test_every_code_that_actions_can_get_has_its_broken_submission() -> None:
    assert {path.stem for path in BROKEN} == {code for code in catalogue() if code.startswith(CODES)}


@pytest.mark.parametrize("slip", SLIPS, ids=lambda slip: slip.name.replace(" ", "_").replace(",", ""))
def test_slip_fails_its_check_and_is_named(slip: Slip, gradings: Gradings, folder: Path) -> None:
    report = gradings.of(slip_file(slip, folder))
    first = next(check for check in report.checks if check.status != "passed")
    assert (first.id, first.status, first.diagnosis) == (slip.check, "failed", slip.code)
    assert slip.fact in first.message
    assert first.hint


def test_every_check_is_failed_by_some_slip_or_broken_submission(gradings: Gradings) -> None:
    report = gradings.of(SOLUTION)
    by_slips = {slip.check for slip in SLIPS}
    assert {check.id for check in report.checks} == by_slips | set(BY_BROKEN.values())
    for code, check_id in BY_BROKEN.items():
        failed = [
            check.id for check in gradings.of(BROKEN[0].with_name(f"{code}.py")).checks if check.status == "failed"
        ]
        assert failed == [check_id]


def test_starter_fails_with_the_first_hint(gradings: Gradings) -> None:
    report = gradings.of(STARTER)
    first = next(check for check in report.checks if check.status == "failed")
    assert not report.passed
    assert (first.id, first.diagnosis) == ("succeeds", "action.no_terminal")
    assert first.hint is not None
    assert "Begin with the drive alone" in first.hint


def test_starter_notebook_holds_the_starter(gradings: Gradings) -> None:
    program = submission.read(STARTER, EXERCISE).source
    cell = submission.read(NOTEBOOK, EXERCISE).source
    assert program[program.index("class MoveRobotServer") : program.index("\n\ndef main")].rstrip() in cell
    statuses = [[check.status for check in gradings.of(path).checks] for path in (STARTER, NOTEBOOK)]
    assert statuses[0] == statuses[1]


def test_exec_grades_a_command() -> None:
    report = grading.grade(EXERCISE, exec_command=shlex.join([sys.executable, str(SOLUTION)]))
    assert failures(report) == []


def test_attach_grades_a_robot_that_has_driven_before(domain: int) -> None:
    """At a quarter of its speed: what is attached to keeps its own time scale."""
    with subprocess.Popen(
        [sys.executable, str(SOLUTION)],
        env=environment.child_environment(ROS_DOMAIN_ID=str(domain), COURSE_KIT_TIME_SCALE="0.25"),
        stderr=subprocess.DEVNULL,
    ) as program:
        try:
            for _ in range(2):  # the second time the robot stands where the first has left it
                report = grading.grade(EXERCISE, attach=True)
                assert failures(report) == []
        finally:
            program.send_signal(signal.SIGINT)
            program.wait(20)
