"""Exercise 2 in other files, and graded without being started by us; styles, mistakes and checks: tests/proof."""

from __future__ import annotations

import json
import shlex
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment, grading
from tests.grading.conftest import ROOT
from tests.reading import read

if TYPE_CHECKING:
    from pathlib import Path

EXERCISE = "move_robot"
STARTER = ROOT / "exercises" / EXERCISE / f"{EXERCISE}.py"
NOTEBOOK = STARTER.with_suffix(".ipynb")
SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"


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
    return {"windows": windows, "notebook": notebook}


def failures(report: grading.Report) -> list[tuple[str, str, str]]:
    return [(check.id, check.status, check.message) for check in report.checks if check.status != "passed"]


@pytest.mark.parametrize("guise", ["windows", "notebook"])
def test_solution_in_any_file_gets_full_marks(guise: str, worker: grading.Worker, tmp_path: Path) -> None:
    assert failures(grading.grade(EXERCISE, made_files(tmp_path)[guise], worker=worker)) == []


def test_starter_notebook_holds_the_starter() -> None:
    program = read(STARTER, EXERCISE).source
    cell = read(NOTEBOOK, EXERCISE).source
    assert program[program.index("class MoveRobotServer") : program.index("\n\ndef main")].rstrip() in cell


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
