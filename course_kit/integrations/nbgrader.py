"""For courses that run on nbgrader: the last line of a test cell, which turns our grade into nbgrader's points.

nbgrader gives a test cell no points when the cell raises or writes to stderr, and otherwise as many as the number
says that its last line shows. So feedback is printed to stdout, and so is whatever else writes meanwhile.
"""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack, contextmanager, redirect_stderr
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.integrations.grade_magics import nothing_from, of_this_notebook

if TYPE_CHECKING:
    from collections.abc import Iterator

    from IPython.core.interactiveshell import InteractiveShell

_DIGITS = 6
_STDOUT, _STDERR = 1, 2


def points(exercise: str, *, points: float | None = None, seed: int | None = None) -> float:
    """Grade what this notebook's `%%submission` cells hold, print the feedback, and return the points."""
    from course_kit.grading import render_text
    from course_kit.grading.exercise import load

    if points is not None and points < 0:
        raise ValueError(f"A cell cannot have fewer than 0 points: points={points} is negative.")
    task = load(exercise)
    most = task.points if points is None else points
    magics = of_this_notebook("nbgrader.points")
    _put_all_on_stdout(magics.shell)
    report = magics.grade_cells(exercise, seed)
    if report is None:
        sys.stdout.write(f"{nothing_from(exercise)} 0 points.\n")
        return 0
    sys.stdout.write(f"{render_text(report)}\n")
    if report.status == "error":
        raise GradingError(f"{report.problem} This is not the submission's fault: grade it again.")
    return scaled(report.score, task.points, most)


def scaled(score: float, of: float, most: float) -> float:
    """`score` of `of` points as so many of `most`: without the last digits' noise, a whole number as an int."""
    number = min(round(score / of * most, _DIGITS), most)
    return int(number) if number == int(number) else number


def _put_all_on_stdout(shell: InteractiveShell) -> None:
    """Send what goes to stderr to stdout until the cell has ended."""
    restored = ExitStack()
    restored.enter_context(redirect_stderr(sys.stdout))
    restored.enter_context(_errors_of_c_code_on_stdout())

    def end(_result: object) -> None:
        shell.events.unregister("post_run_cell", end)
        restored.close()

    shell.events.register("post_run_cell", end)  # the last one: after the lab has shown what its nodes have said


@contextmanager
def _errors_of_c_code_on_stdout() -> Iterator[None]:
    """ROS 2 logs there."""
    kept = os.dup(_STDERR)
    os.dup2(_STDOUT, _STDERR)
    try:
        yield
    finally:
        os.dup2(kept, _STDERR)
        os.close(kept)
