"""Submissions graded by a real Otter-Grader: it gives the points we give. `uvx nox --sessions otter` runs it.

Otter would bring pandas, Sphinx and twenty more packages to the test tools. For each exercise it is asked for an
autograder (`otter generate`) out of our test file, and for the points (`otter run`) of our notebook with: the solution,
the solution in two cells, a program that is right in part, the untouched starter, and no submission at all.
"""

from __future__ import annotations

import ast
import json
import subprocess
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest

from course_kit import environment, grading
from course_kit.authoring import corpus
from course_kit.integrations import otter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.authoring.corpus import Corpus, ProofSubmission

ROOT = environment.checkout_folder() or Path()
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


@pytest.mark.timeout(3600)
@pytest.mark.parametrize("name", corpus.all_exercises(ROOT))
def test_otter_gives_our_points(name: str, tmp_path: Path) -> None:
    exercise = corpus.load_corpus(name, ROOT)
    with environment.exclusive_domain() as domain:
        otters = Otter(tmp_path, name, domain)
        found = {case.name: otters.points(_notebook(exercise, case.cells)) for case in cases(exercise)}
    assert found == pytest.approx({case.name: case.points for case in cases(exercise)})


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


def text_of(one: ProofSubmission) -> str:
    return one.texts()[one.path.name]


def cases(exercise: Corpus) -> list[Case]:
    """What is handed in for an exercise, with the points our grader gives."""
    with tempfile.TemporaryDirectory() as folder, grading.Worker() as worker:
        path = Path(folder) / "program.py"

        def worth(text: str) -> float:
            path.write_text(text, encoding="utf-8")
            return grading.grade(exercise.exercise.id, path, seed=_SEED, worker=worker).score

        solution = text_of(exercise.of_kind("solution")[0])
        full = worth(solution)
        wrong = ((one.name, text_of(one), worth(text_of(one))) for one in exercise.of_kind("broken"))
        in_part = next(((name, text, points) for name, text, points in wrong if _LITTLE * full < points < full))
        starter = next(text_of(one) for one in exercise.of_kind("starter") if one.path.suffix == ".py")
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
    notebook = nbformat.read(exercise.exercise.folder / exercise.exercise.notebook, as_version=4)
    mark = f"%%submission {exercise.exercise.id}\n"
    place = next(number for number, cell in enumerate(notebook.cells) if cell.source.startswith(mark))
    notebook.cells[place : place + 1] = [nbformat.v4.new_code_cell(mark + cell) for cell in cells]
    for cell in notebook.cells:
        if cell.source.startswith("%grade "):
            cell.source = _CHECK.format(exercise.exercise.id)
    return notebook
