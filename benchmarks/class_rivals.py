"""The contestants of `class.py`: how each is set up, which command it is run with, and where its scores stand.

All are given the same programs and do the same checks (`class_work.points`); a notebook holds the program in one cell
and the checks in the next. A program that does not end gets the same time everywhere. Setting up (making a course,
writing notebooks) is not measured; starting is.
"""
# ruff: noqa: D102 - what the methods do stands in `Contestant`

from __future__ import annotations

import json
import os
import re
import sqlite3
import subprocess
import sys
from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import nbformat
from class_work import CLASS_NAME, LIMIT_S
from measure import Command

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Sequence

    from class_submissions import Submission

BENCHMARKS = Path(__file__).resolve().parent
FULL = {"temperature_service": 10.0, "move_robot": 20.0, "robot_parameters": 20.0}
_SCORE = re.compile(r"\d+\.\d+")
_WORK = "work"  # the assignment, its notebook and its test cell
_CHECKS = f"from class_work import points\n\npoints({CLASS_NAME})"
_NBGRADER = f"""
c = get_config()
c.CourseDirectory.course_id = "ros"
c.Execute.timeout = {LIMIT_S}
"""


class Contestant(ABC):
    """One way to grade some submissions with one worker, in a folder of its own."""

    title: ClassVar[str]

    def __init__(self, folder: Path, domain: int, workers: int) -> None:
        """Work in `folder`, with nodes on `domain`; `workers` is for those that have their own."""
        self.folder, self.workers = folder, workers
        folder.mkdir(parents=True)
        # Our environment, with nothing of the user's own in Jupyter's settings.
        private = {name: str(folder / "jupyter") for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "IPYTHONDIR")}
        paths = {
            "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
            "PYTHONPATH": os.pathsep.join(filter(None, (str(BENCHMARKS), os.environ.get("PYTHONPATH", "")))),
        }
        self._variables = environment.child_environment(ROS_DOMAIN_ID=str(domain), **private, **paths)

    @abstractmethod
    def prepare(self, submissions: Sequence[Submission]) -> None:
        """Everything that is done once before submissions come in, and laying them out."""

    @abstractmethod
    def words(self, submissions: Sequence[Submission]) -> list[str]:
        """What is measured: words for Python."""

    @abstractmethod
    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        """The scores, so that everybody sees that the work was done; those that have none are left out."""

    def command(self, submissions: Sequence[Submission]) -> Command:
        """What is measured, ready to run."""
        return Command([sys.executable, *self.words(submissions)], self.folder, self._variables)


class Ours(Contestant):
    """`course-kit class`, with full isolation and reports; it shares the work among its workers itself."""

    title = "course-kit class"

    def prepare(self, submissions: Sequence[Submission]) -> None:
        for one in submissions:
            path = self.folder / "in" / one.student / f"{one.exercise}.py"
            path.parent.mkdir(parents=True)
            path.write_text(one.text, encoding="utf-8")

    def words(self, submissions: Sequence[Submission]) -> list[str]:
        more = ["--workers", str(self.workers)] if self.workers else []
        where = [str(self.folder / "in"), "--out", str(self.folder / "out"), "--exercise", submissions[0].exercise]
        return ["-m", "course_kit", "class", *where, *more, "--seed", "1"]

    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        del submissions
        found = self.folder.glob("out/students/*/*.json")
        return [json.loads(path.read_text(encoding="utf-8"))["report"]["score"] for path in found]


class Fork(Contestant):
    """One warm process that forks for each program, without isolation: the least it can cost."""

    title = "lower bound: fork from a warm process"

    def prepare(self, submissions: Sequence[Submission]) -> None:
        for one in submissions:
            (self.folder / f"{one.student}.py").write_text(one.text, encoding="utf-8")

    def words(self, submissions: Sequence[Submission]) -> list[str]:
        return [str(BENCHMARKS / "class_work.py"), *(f"{one.student}.py" for one in submissions)]

    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        del submissions
        log = (self.folder / "log").read_text(encoding="utf-8", errors="replace")
        return [float(line) for line in log.splitlines() if _SCORE.fullmatch(line)]


class Nbgrader(Contestant):
    """`nbgrader autograde` for all at once."""

    title = "nbgrader, one batch"

    def prepare(self, submissions: Sequence[Submission]) -> None:
        (self.folder / "nbgrader_config.py").write_text(_NBGRADER, encoding="utf-8")
        self._write(self.folder / "source" / _WORK, f"class {CLASS_NAME}:\n    pass")
        words = [sys.executable, "-m", "nbgrader", "generate_assignment", _WORK]
        subprocess.run(words, cwd=self.folder, env=self._variables, capture_output=True, timeout=300, check=True)
        for one in submissions:
            self._write(self.folder / "submitted" / one.student / _WORK, one.cell)

    def _write(self, folder: Path, program: str) -> None:
        folder.mkdir(parents=True)
        notebook = _notebook(program, _CHECKS)
        plain = {"grade": False, "solution": False, "locked": False, "task": False, "schema_version": 3}
        answer, checks = notebook.cells
        answer.metadata["nbgrader"] = {**plain, "grade_id": "answer", "solution": True}
        checks.metadata["nbgrader"] = {**plain, "grade_id": "checks", "grade": True, "locked": True, "points": 10}
        nbformat.write(notebook, folder / f"{_WORK}.ipynb")

    def words(self, submissions: Sequence[Submission]) -> list[str]:
        del submissions
        return ["-m", "nbgrader", "autograde", _WORK]

    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        del submissions
        with sqlite3.connect(self.folder / "gradebook.db") as database:
            return [score for (score,) in database.execute("SELECT auto_score FROM grade") if score is not None]


CONTESTANTS: tuple[type[Contestant], ...] = (Ours, Fork, Nbgrader)


def _notebook(*cells: str) -> Any:
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return notebook
