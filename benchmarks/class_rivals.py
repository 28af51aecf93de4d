"""The contestants of `class.py`: how each is set up, which commands it is run with, and where its scores stand.

All are given the same programs and do the same checks (`class_work.points`); a notebook holds the program in one cell
and the checks in the next. A program that does not end gets the same time everywhere. Setting up (making a course,
writing notebooks) is not measured; starting is.
"""
# ruff: noqa: D102 - what the methods do stands in `Contestant`

from __future__ import annotations

import importlib.util
import json
import os
import re
import sqlite3
import subprocess
import sys
import zipfile
from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import nbformat
from class_usage import Command, python
from class_work import CLASS_NAME, LIMIT_S

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Sequence

    from class_submissions import Submission

BENCHMARKS = Path(__file__).resolve().parent
FULL = 10.0
_SCORE = re.compile(r"\d+\.\d+")
_WORK = "work"  # the assignment, its notebook and its test cell
_CHECKS = f"from class_work import points\n\npoints({CLASS_NAME})"
_NBGRADER = f"""
c = get_config()
c.CourseDirectory.course_id = "ros"
c.Execute.timeout = {LIMIT_S}
"""
# Otter sets no limit for a cell; so its notebooks do it themselves.
_ALARM = f"""import signal

def give_up(*_):
    raise TimeoutError

signal.signal(signal.SIGALRM, give_up)
signal.alarm({LIMIT_S})"""
_OTTER_TEST = f"""OK_FORMAT = True
test = {{
    "name": "{_WORK}",
    "points": 10,
    "suites": [{{
        "cases": [{{"code": ">>> from class_work import points\\n>>> points({CLASS_NAME})\\n10.0", "hidden": False}}],
        "scored": True, "setup": "", "teardown": "", "type": "doctest",
    }}],
}}
"""
_OTTER_LOOP = """import json, sys
from otter.api import grade_submission

archive, out, *notebooks = sys.argv[1:]
scores = {path: grade_submission(path, archive, quiet=True).total for path in notebooks}
with open(out, "w") as file:
    json.dump(list(scores.values()), file)
"""


class Contestant(ABC):
    """One way to grade some submissions with one worker, in a folder of its own."""

    title: ClassVar[str]
    needs: ClassVar[str] = ""  # a package

    def __init__(self, folder: Path, domain: int, workers: int) -> None:
        """Work in `folder`, with nodes on `domain`; `workers` is for those that have their own."""
        self.folder, self.workers = folder, workers
        folder.mkdir(parents=True)
        self._variables = _environment(folder, domain)

    @classmethod
    def missing(cls) -> bool:
        """Whether a package it needs is not installed."""
        return bool(cls.needs) and importlib.util.find_spec(cls.needs) is None

    @abstractmethod
    def prepare(self, submissions: Sequence[Submission]) -> None:
        """Everything that is done once before submissions come in, and laying them out."""

    @abstractmethod
    def commands(self, submissions: Sequence[Submission]) -> list[list[str]]:
        """What is measured, one after the other."""

    @abstractmethod
    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        """The scores, so that everybody sees that the work was done; those that have none are left out."""

    def queue(self, submissions: Sequence[Submission]) -> list[Command]:
        """The commands, ready to run."""
        return [self._command(words) for words in self.commands(submissions)]

    def _command(self, words: Sequence[str]) -> Command:
        return Command(words, self.folder, self._variables, self.folder / "log")

    def _once(self, *words: str) -> None:
        done = subprocess.run(
            words, cwd=self.folder, env=self._variables, capture_output=True, text=True, timeout=300, check=False
        )
        if done.returncode:
            raise SystemExit(f"{self.title} could not be set up:\n{done.stdout}{done.stderr}")


class Ours(Contestant):
    """`course-kit class`, with full isolation and reports; it shares the work among its workers itself."""

    title = "course-kit class"

    def prepare(self, submissions: Sequence[Submission]) -> None:
        for one in submissions:
            path = self.folder / "in" / one.student / f"{one.exercise}.py"
            path.parent.mkdir(parents=True)
            path.write_text(one.text, encoding="utf-8")

    def commands(self, submissions: Sequence[Submission]) -> list[list[str]]:
        more = ["--workers", str(self.workers)] if self.workers else []
        for exercise in sorted({one.exercise for one in submissions}):
            more += ["--exercise", exercise]
        words = ["class", str(self.folder / "in"), "--out", str(self.folder / "out"), *more]
        return [python("-m", "course_kit", *words, "--seed", "1")]

    def reports(self) -> dict[str, dict[str, Any]]:
        """By student."""
        found = self.folder.glob("out/students/*/*.json")
        return {path.parent.name: json.loads(path.read_text(encoding="utf-8"))["report"] for path in found}

    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        reports = self.reports()
        return [reports[one.student]["score"] for one in submissions if one.student in reports]


class Fork(Contestant):
    """One warm process that forks for each program, without isolation: the least it can cost."""

    title = "lower bound: fork from a warm process"

    def prepare(self, submissions: Sequence[Submission]) -> None:
        for one in submissions:
            (self.folder / f"{one.student}.py").write_text(one.text, encoding="utf-8")

    def commands(self, submissions: Sequence[Submission]) -> list[list[str]]:
        return [python(str(BENCHMARKS / "class_work.py"), *(f"{one.student}.py" for one in submissions))]

    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        del submissions
        log = (self.folder / "log").read_text(encoding="utf-8", errors="replace")
        return [float(line) for line in log.splitlines() if _SCORE.fullmatch(line)]


class Nbgrader(Contestant):
    """`nbgrader autograde` for all at once."""

    title = "nbgrader, one batch"
    needs = "nbgrader"

    def prepare(self, submissions: Sequence[Submission]) -> None:
        (self.folder / "nbgrader_config.py").write_text(_NBGRADER, encoding="utf-8")
        self._write(self.folder / "source" / _WORK, f"class {CLASS_NAME}:\n    pass")
        self._once(*python("-m", "nbgrader", "generate_assignment", _WORK))
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

    def commands(self, submissions: Sequence[Submission]) -> list[list[str]]:
        del submissions
        return [python("-m", "nbgrader", "autograde", _WORK)]

    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        del submissions
        with sqlite3.connect(self.folder / "gradebook.db") as database:
            return [score for (score,) in database.execute("SELECT auto_score FROM grade") if score is not None]


class OtterLoop(Contestant):
    """Otter's function for one submission, called in a loop."""

    title = "otter, a loop in Python"
    needs = "otter"

    def prepare(self, submissions: Sequence[Submission]) -> None:
        with zipfile.ZipFile(self.folder / "autograder.zip", "w") as archive:
            archive.writestr("otter_config.json", "{}")
            archive.writestr(f"tests/{_WORK}.py", _OTTER_TEST)
        for one in submissions:
            nbformat.write(_notebook(_ALARM, one.cell, "signal.alarm(0)"), self.folder / f"{one.student}.ipynb")
        (self.folder / "loop.py").write_text(_OTTER_LOOP, encoding="utf-8")

    def commands(self, submissions: Sequence[Submission]) -> list[list[str]]:
        return [python("loop.py", "autograder.zip", "scores.json", *(f"{one.student}.ipynb" for one in submissions))]

    def scores(self, submissions: Sequence[Submission]) -> list[float]:
        del submissions
        path = self.folder / "scores.json"
        return list(json.loads(path.read_text(encoding="utf-8"))) if path.exists() else []


CONTESTANTS: dict[str, type[Contestant]] = {"ours": Ours, "fork": Fork, "nbgrader": Nbgrader, "otter-loop": OtterLoop}


def _notebook(*cells: str) -> Any:
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return notebook


def _environment(folder: Path, domain: int) -> dict[str, str]:
    """Our environment, with nothing of the user's own in Jupyter's settings."""
    private = {name: str(folder / "jupyter") for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "IPYTHONDIR")}
    paths = {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": os.pathsep.join(filter(None, (str(BENCHMARKS), os.environ.get("PYTHONPATH", "")))),
    }
    return environment.child_environment(ROS_DOMAIN_ID=str(domain), **private, **paths)
