"""`%%submission` and `%grade`: hand in from a notebook, and see the grade there."""

from __future__ import annotations

import os
import shlex
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import nbformat
from IPython.core.getipython import get_ipython
from IPython.core.magic import Magics, cell_magic, line_magic, magics_class
from IPython.display import display

from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from course_kit.grading import Report

NBGRADER = "NBGRADER_EXECUTION"  # set by it for the kernels it starts
USAGE = "Use it as %grade EXERCISE, or %grade EXERCISE FILE [--seed N]."


class Card:
    """A report as a notebook shows it: a card where there is HTML, plain text elsewhere."""

    def __init__(self, report: Report, folder: Path | None = None) -> None:
        """Show `report` in a notebook that lies in `folder`, the present one when None."""
        self._report, self._folder = report, folder

    def _repr_html_(self) -> str:
        from course_kit import grading

        return grading.render_html(self._report, self._folder)

    def __repr__(self) -> str:
        from course_kit import grading

        return grading.render_text(self._report)


class SubmissionCells:
    """The `%%submission` cells of this session as last run, in the notebook's order."""

    def __init__(self) -> None:
        self._cells: dict[str, dict[str, str]] = {}

    def keep(self, exercise: str, cell_id: str | None, source: str) -> None:
        """Remember a cell's text; a cell without an id (no JupyterLab behind it) replaces all of its exercise.

        Args:
            exercise: its id.
            cell_id: the cell's, empty when it has none.
            source: its text.
        """
        cells = self._cells.setdefault(exercise, {})
        if cell_id is None:
            cells.clear()
        cells[cell_id or ""] = source

    def of(self, exercise: str) -> list[str]:
        """The texts that make up the submission, magic lines included."""
        order = {cell_id: place for place, cell_id in enumerate(_ids_in_file())}
        cells = self._cells.get(exercise, {})
        return [cells[cell_id] for cell_id in sorted(cells, key=lambda cell_id: order.get(cell_id, len(order)))]


def _ids_in_file() -> list[str]:
    """Cell ids of the notebook this kernel belongs to, as last saved; empty where the server does not name it."""
    path = Path(os.environ.get("JPY_SESSION_NAME", ""))
    try:
        return [cell.get("id", "") for cell in nbformat.read(path, as_version=4).cells]
    except Exception:  # noqa: BLE001 - no such file, not saved yet, half written: the order of running will do
        return []


def _notebook_folder() -> Path | None:
    """Where the notebook lies; a learner may have changed the kernel's own folder. None where nobody tells."""
    session = Path(os.environ.get("JPY_SESSION_NAME", ""))
    return session.parent if session.is_absolute() else None


@magics_class
class GradeMagics(Magics):
    """The magics of exercises."""

    def __init__(self, shell: InteractiveShell) -> None:
        super().__init__(shell)
        self._submissions = SubmissionCells()
        self._reports: dict[tuple[str, int | None], Report] = {}

    @cell_magic
    def submission(self, line: str, cell: str) -> None:
        """Run the cell as usual, and keep it for `%grade`: `%%submission EXERCISE`."""
        exercise = line.strip()
        if not exercise:
            complain(f"Name the exercise: %%submission EXERCISE. {the_exercises()}")
            return
        try:
            require(exercise)
        except GradingError as problem:
            complain(str(problem))
            return
        self._submissions.keep(exercise, self._cell_id(), f"%%submission {line}\n{cell}")
        self._reports.clear()
        # A script's last lines start its node for ever; in the notebook the lab does that.
        namespace_name = self.shell.user_ns.get("__name__")
        self.shell.user_ns["__name__"] = exercise
        try:
            self.shell.run_cell(cell)
        finally:
            self.shell.user_ns["__name__"] = namespace_name

    @line_magic
    def grade(self, line: str) -> None:
        """Grade the notebook's submission, or a file: `%grade EXERCISE [FILE] [--seed N]`."""
        try:
            exercise, file, seed = parse(line)
        except ValueError:
            complain(f"{USAGE} {the_exercises()}")
            return
        from course_kit import grading
        from course_kit.learner import progress

        try:
            report = grading.grade(exercise, file, seed=seed) if file else self.grade_cells(exercise, seed)
        except GradingError as problem:
            complain(str(problem))
            return
        if report is None:
            complain(f"Nothing to grade yet: run the cell that begins with %%submission {exercise}, then grade again.")
            return
        display(Card(report, _notebook_folder()))
        if trouble := progress.record(report):
            complain(trouble)

    def grade_cells(self, exercise: str, seed: int | None = None) -> Report | None:
        """Grade what was last run in the exercise's `%%submission` cells; None when there were none.

        Raises:
            GradingError: there is no such exercise, or a broken installation.
        """
        from course_kit import grading

        require(exercise)
        cells = [nbformat.v4.new_code_cell(cell) for cell in self._submissions.of(exercise)]
        if not cells:
            return None
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "notebook.ipynb"
            nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
            return grading.grade(exercise, path, seed=seed)

    def report(self, exercise: str, seed: int | None = None) -> Report | None:
        """As `grade_cells`, but who asks again gets the same report until a `%%submission` cell is run again."""
        key = exercise, seed
        if key not in self._reports:
            report = self.grade_cells(exercise, seed)
            if report is None:
                return None
            self._reports[key] = report
        return self._reports[key]

    def _cell_id(self) -> str | None:
        get_parent = getattr(self.shell, "get_parent", None)
        parent: dict[str, Any] = get_parent() if get_parent else {}
        cell_id = parent.get("metadata", {}).get("cellId")
        if isinstance(cell_id, str):
            return cell_id
        # Graders name no cells; but they run each once, from top to bottom.
        return f"cell {self.shell.execution_count}" if _in_an_autograder() else None


def of_this_notebook(caller: str) -> GradeMagics:
    """The magics of the notebook we run in, for `caller`, a function that an instructor writes there.

    Raises:
        GradingError: the course kit was not loaded into a notebook.
    """
    shell = get_ipython()
    magics = shell.magics_manager.registry.get("GradeMagics") if shell else None
    if not isinstance(magics, GradeMagics):
        raise GradingError(
            f"{caller}() needs the notebook's submission. Have a locked cell above it with: %load_ext course_kit"
        )
    return magics


def nothing_from(exercise: str) -> str:
    """What to say where there is nothing to grade."""
    return f"Nothing was handed in: no cell that begins with %%submission {exercise} was run."


def _in_an_autograder() -> bool:
    """Whether nbgrader or Otter runs this notebook, and no person."""
    otter = getattr(sys.modules.get("otter"), "Notebook", None)
    return NBGRADER in os.environ or bool(getattr(otter, "_grading_mode", False))


def parse(line: str) -> tuple[str, str | None, int | None]:
    """Exercise, file and seed of a `%grade` line.

    Raises:
        ValueError: it is something else.
    """
    words = shlex.split(line)
    seed = None
    if "--seed" in words:
        place = words.index("--seed")
        seed = int(words[place + 1]) if place + 1 < len(words) else int("")
        del words[place : place + 2]
    if not 1 <= len(words) <= 2 or any(word.startswith("-") for word in words):  # noqa: PLR2004 - exercise and file
        raise ValueError(line)
    return words[0], words[1] if len(words) > 1 else None, seed


def require(exercise: str) -> None:
    """See that there is such an exercise.

    Raises:
        GradingError: there is none; names the nearest.
    """
    from course_kit.grading.exercise import load

    load(exercise)


def the_exercises() -> str:
    """A sentence that names the exercises there are."""
    from course_kit.grading.exercise import ids

    try:
        return f"There are: {', '.join(ids())}."
    except GradingError as problem:
        return str(problem)


def complain(sentence: str) -> None:
    """Say what is wrong, without a traceback."""
    print(sentence, file=sys.stderr)
