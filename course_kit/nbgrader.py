"""What the test cells of an nbgrader assignment import.

nbgrader gives a test cell no points when the cell raises or writes to stderr, and otherwise as many as the number
says that its last line shows. So `points` prints the feedback to stdout, where all that writes meanwhile goes, too.
"""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack, redirect_stderr
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.integrations.grade_magics import magics_of_notebook, nothing_from

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

__all__ = ["points"]
_DIGITS = 6  # of points
_STDOUT, _STDERR = 1, 2


def points(exercise: str, *, points: float | None = None, seed: int | None = None) -> float:
    """Grade what this notebook's `%%submission` cells hold, print the feedback, and return the points."""
    from course_kit.grading import render_text

    if points is not None and points < 0:
        raise ValueError(f"A cell cannot have fewer than 0 points: points={points} is negative.")
    magics = magics_of_notebook("nbgrader.points")
    _put_all_on_stdout(magics.shell)
    report = magics.grade_cells(exercise, seed)
    if report is None:
        sys.stdout.write(f"{nothing_from(exercise)} 0 points.\n")
        return 0
    sys.stdout.write(f"{render_text(report)}\n")
    if report.status == "error":
        raise GradingError(f"{report.problem} This is not the submission's fault: grade it again.")
    return scale_score(report.score, report.max_score, report.max_score if points is None else points)


def scale_score(score: float, of: float, most: float) -> float:
    """`score` of `of` points as so many of `most`: without the last digits' noise, a whole number as an int."""
    number = min(round(score / of * most, _DIGITS), most)
    return int(number) if number == int(number) else number


def _put_all_on_stdout(shell: InteractiveShell) -> None:
    """Send what goes to stderr, where ROS 2 logs in C, to stdout until the cell has ended."""
    restored, stderr = ExitStack(), os.dup(_STDERR)
    restored.callback(os.close, stderr)
    restored.callback(os.dup2, stderr, _STDERR)
    os.dup2(_STDOUT, _STDERR)
    restored.enter_context(redirect_stderr(sys.stdout))

    def end(_result: object) -> None:
        shell.events.unregister("post_run_cell", end)
        restored.close()

    shell.events.register("post_run_cell", end)  # the last one: after the lab has shown what its nodes have said
