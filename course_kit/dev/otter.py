"""`course-kit dev otter`: grades submissions by a real Otter-Grader, and says whether it gives the points we give.

Otter is no part of the test tools: it would bring pandas, Sphinx and twenty more packages. Install it with the extra
`bench` where this is to run. For each exercise it is asked for an autograder (`otter generate`) out of our test file,
and for the points (`otter run`) of our notebook with: the solution, the solution in two cells, a program that is right
in part, the untouched starter, and no submission at all.
"""

from __future__ import annotations

import argparse
import ast
import importlib.util
import json
import subprocess
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat

from course_kit import environment, grading
from course_kit.authoring import corpus
from course_kit.integrations import otter
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.authoring.corpus import Corpus

_SEED = 1
_LITTLE = 0.3  # of the points; with more a program is right in part
_PATIENCE_S = 600.0  # against hanging only
_CHECK = 'import otter\n\ngrader = otter.Notebook()\ngrader.check("{}")'


@dataclass(frozen=True)
class Case:
    """What is handed in: a name for the table, the texts of the submission's cells, and the points it is worth."""

    name: str
    cells: tuple[str, ...]
    points: float


def main(arguments: Sequence[str]) -> int:
    """The command: 0 when Otter's points are ours, 1 when some are not, 2 when it could not be tried."""
    parser = argparse.ArgumentParser(prog="course-kit dev otter", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("exercises", nargs="*", metavar="EXERCISE", help="all, when none is named")
    options = parser.parse_args(arguments)
    root = environment.checkout()
    if root is None or not (root / "solutions").is_dir() or importlib.util.find_spec("otter") is None:
        return cannot('this needs a clone of the course and, in its environment, pip install -e ".[bench]"')
    try:
        chosen = [corpus.load(name, root) for name in options.exercises or corpus.all_exercises(root)]
    except grading.GradingError as problem:
        return cannot(problem)
    print(f"{'exercise':<20} {'handed in':<34} {'ours':>6} {'Otter':>6}")
    return min(1, sum(not _agrees(one) for one in chosen))


def _agrees(exercise: Corpus) -> bool:
    """Print a line for each submission of an exercise; whether Otter gives all of them our points."""
    agrees = True
    with tempfile.TemporaryDirectory() as folder, environment.exclusive_domain() as domain:
        otters = Otter(Path(folder), exercise.task.id, domain)
        for case in cases(exercise):
            points = otters.points(_notebook(exercise, case.cells))
            same = abs(points - case.points) < 1e-6  # noqa: PLR2004 - the noise of a sum
            agrees = agrees and same
            mark = "" if same else "  DIFFERS"
            print(f"{exercise.task.id:<20} {case.name:<34} {case.points:>6g} {points:>6g}{mark}", flush=True)
    return agrees


class Otter:
    """Otter's commands, in a folder of their own."""

    def __init__(self, folder: Path, exercise: str, domain: int) -> None:
        """Make the autograder of an exercise.

        Args:
            folder: where Otter works.
            exercise: its id.
            domain: the ROS domain of what is graded.
        """
        self._folder = folder
        private = {name: str(folder / "jupyter") for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "IPYTHONDIR")}
        self._environment = environment.child_environment(ROS_DOMAIN_ID=str(domain), **private)
        (folder / "tests").mkdir()
        (folder / "tests" / f"{exercise}.py").write_text(otter.case_file(exercise, _SEED), encoding="utf-8")
        self._run("generate", "--tests-dir", "tests", "--output-path", "autograder.zip")

    def points(self, notebook: nbformat.NotebookNode) -> float:
        """What it gives to a notebook."""
        nbformat.write(notebook, self._folder / "notebook.ipynb")
        results = self._folder / "results.json"
        with suppress(FileNotFoundError):
            results.unlink()
        self._run("run", "--autograder", "autograder.zip", "--no-logo", "notebook.ipynb")
        found = json.loads(results.read_text(encoding="utf-8"))
        return float(sum(test.get("score", 0.0) for test in found["tests"]))

    def _run(self, *words: str) -> None:
        done = subprocess.run(
            [sys.executable, "-m", "otter", *words],
            cwd=self._folder,
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=_PATIENCE_S,
            check=False,
        )
        if done.returncode:
            raise SystemExit(f"otter {words[0]} has failed:\n{done.stdout}")


def cases(exercise: Corpus) -> list[Case]:
    """What is handed in for an exercise, with the points our grader gives."""
    with tempfile.TemporaryDirectory() as folder, grading.Worker() as worker:
        path = Path(folder) / "program.py"

        def worth(text: str) -> float:
            path.write_text(text, encoding="utf-8")
            return grading.grade(exercise.task.id, path, seed=_SEED, worker=worker).score

        solution = exercise.of("solution")[0].text()
        full = worth(solution)
        wrong = ((one.name, one.text(), worth(one.text())) for one in exercise.of("broken"))
        in_part = next(((name, text, points) for name, text, points in wrong if _LITTLE * full < points < full))
        starter = next(one.text() for one in exercise.of("starter") if one.path.suffix == ".py")
        return [
            Case("the solution", (solution,), full),
            Case("the solution in two cells", _halves(solution), full),
            Case(in_part[0], (in_part[1],), in_part[2]),
            Case("the starter", (starter,), worth(starter)),
            Case("nothing", (), 0.0),
        ]


def _halves(text: str) -> tuple[str, str]:
    """A program in two parts, the second of which holds its last statement."""
    lines = text.splitlines()
    last = ast.parse(text).body[-1].lineno - 1
    return "\n".join(lines[:last]), "\n".join(lines[last:])


def _notebook(exercise: Corpus, cells: Sequence[str]) -> nbformat.NotebookNode:
    """The exercise's notebook with `cells` as its submission, and Otter's check where it was graded."""
    notebook = nbformat.read(exercise.task.folder / exercise.task.notebook, as_version=4)
    mark = f"%%submission {exercise.task.id}\n"
    place = next(number for number, cell in enumerate(notebook.cells) if cell.source.startswith(mark))
    notebook.cells[place : place + 1] = [nbformat.v4.new_code_cell(mark + cell) for cell in cells]
    for cell in notebook.cells:
        if cell.source.startswith("%grade "):
            cell.source = _CHECK.format(exercise.task.id)
    return notebook
