"""`%%submission` and `%grade`: hand in from a notebook, and see the grade there."""

from __future__ import annotations

import functools
import html
import os
import re
import shlex
import sys
import tempfile
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

import nbformat
from IPython.core.error import UsageError
from IPython.core.getipython import get_ipython
from IPython.core.magic import Magics, cell_magic, line_magic, magics_class
from IPython.core.magic_arguments import MagicArgumentParser
from IPython.display import display

from course_kit import environment
from course_kit.environment.notebook import notebook_path
from course_kit.grading.errors import GradingError
from course_kit.integrations.at_start import is_new
from course_kit.integrations.submission_cells import SubmissionCells
from course_kit.reader.files import is_name
from course_kit.reader.text import PROGRAM, UnreadableTextError, join_cells

if TYPE_CHECKING:
    from collections.abc import Callable

    from IPython.core.interactiveshell import ExecutionInfo, ExecutionResult, InteractiveShell

    from course_kit.grading import Report

P = ParamSpec("P")
_LESSON = re.compile(r"notebooks/[\w-]+\.ipynb")
NBGRADER = "NBGRADER_EXECUTION"  # set by it for the kernels it starts
_PAGE = "flex: 1 1 32em; min-width: 0"  # of two programs; where both do not fit, one stands below the other
_LISTING = "white-space: pre; overflow-x: auto"  # JupyterLab would break lines within words
_EXPLORE = (
    "Not done yet. Look at the symptom again, ask the graph what is there, and say the cause in one sentence. "
    "The next %grade says what the grader saw, and why."
)
USAGE = "Use it as %grade EXERCISE, or %grade EXERCISE FILE; behind it, --only PART and --seed N."


def _show_report(report: Report, following: str) -> None:
    """Show a card where there is HTML, with a link to the lesson that comes next, and plain text elsewhere."""
    from course_kit import grading

    session = notebook_path()  # a learner may have changed the kernel's own folder
    card = grading.render_html(report, session.parent if session.is_absolute() else None)
    lesson = _LESSON.search(following)
    link = f'<p>Go on with <a href="../../{lesson[0]}">{lesson[0]}</a>.</p>' if lesson else ""
    display({"text/plain": grading.render_text(report), "text/html": f"{card}{link}"}, raw=True)


def print_complaint(sentence: object) -> None:
    """Say what is wrong, without a traceback."""
    print(sentence, file=sys.stderr)


def complains(magic: Callable[P, None]) -> Callable[P, None]:
    """Have a magic say in a sentence why it cannot be done."""

    @functools.wraps(magic)
    def run(*arguments: P.args, **options: P.kwargs) -> None:
        try:
            magic(*arguments, **options)
        except GradingError as problem:
            print_complaint(problem)

    return run


@magics_class
class GradeMagics(Magics):
    """The magics of exercises."""

    def __init__(self, shell: InteractiveShell) -> None:
        super().__init__(shell)
        self._submissions = SubmissionCells()
        self._reports: dict[tuple[str, int | None], Report | None] = {}
        self._within_cell = False  # IPython tells of the rest of a %%submission cell as of a cell
        shell.events.register("pre_run_cell", self._before_cell)
        shell.events.register("post_run_cell", self._after_cell)

    @cell_magic
    @complains
    def submission(self, line: str, cell: str) -> None:
        """Run the cell as usual, and keep it for `%grade`: `%%submission EXERCISE`, or `%%submission EXERCISE FILE`."""
        exercise, _, file = line.strip().partition(" ")
        file = file.strip()
        _require_mark(exercise, file)
        first = f"%%submission {line}\n"
        self._submissions.keep(exercise, self._cell_id(), first + cell, self._number())
        self._reports.clear()
        # A script's last lines start its node for ever; in the notebook the lab does that.
        names = {"__name__": exercise}
        if file:
            names["__file__"] = str(self._save(exercise, file))
            if not file.endswith(PROGRAM):
                return
        before = {name: self.shell.user_ns.get(name) for name in names}
        self.shell.user_ns.update(names)
        try:
            self._run_in_its_cell(first, cell)
        finally:
            self.shell.user_ns.update(before)

    def _save(self, exercise: str, file: str) -> Path:
        """Put a file of a submission beside its others and the scripts, for `%ros_script` and `%ros_launch`."""
        cells = [(str(cell), cell.source) for cell in self._submissions.cells_of(exercise)]
        path = environment.run_dir(environment.paths.CELL_PROGRAMS) / file
        with suppress(UnreadableTextError):  # %grade says what is wrong
            path.write_text(join_cells("This notebook", cells, exercise, file)[0], encoding="utf-8")
        return path

    @line_magic
    @complains
    def grade(self, line: str) -> None:
        """Grade the notebook's submission, or a file: `%grade EXERCISE [FILE] [--only PART] [--seed N]`."""
        try:
            exercise, file, options = parse_line(line)
        except (UsageError, ValueError):
            raise GradingError(f"{USAGE} {the_exercises()}") from None
        from course_kit import grading
        from course_kit.learner import progress
        from course_kit.learner.course_list import next_step

        if file and (advice := grading.advice_for_root()):  # a notebook's own cells have run as root already
            print_complaint(f"{advice[:1].upper()}{advice[1:]}")
        if cells := file or "; ".join(map(str, self._submissions.cells_of(exercise))):
            print(f"Grading {cells}. This takes some seconds, and longer where answers do not come.", flush=True)
        report = grading.grade(exercise, file, **options) if file else self.grade_cells(exercise, **options)
        if report is None:
            why = "The kernel has just been started" if is_new() else "Nothing to grade yet"
            raise GradingError(
                f"{why}: run the cell that begins with %%submission {exercise}, then grade again. "
                "(Run it again after a restart of the kernel. Deleted cells do not count.)"
            )
        if not file:
            for warning in self._submissions.warnings(exercise):
                print_complaint(warning)
        following = next_step(exercise, in_notebook=True) if report.passed and not report.part else ""
        # Whoever tries a drill for the first time looks for the fault before anybody names it.
        if report.practice and not report.passed and exercise not in progress.read_progress()[0]:
            print(_EXPLORE)
        else:
            _show_report(report, following)
        if trouble := progress.record_report(report):
            print_complaint(trouble)
        if following:
            print(following)

    @line_magic
    @complains
    def solution(self, line: str) -> None:
        """Show our solution beside yours, once you have passed: `%solution EXERCISE`."""
        from course_kit.learner import handouts

        ours, sentence = handouts.read_solution(line.strip())
        if sentence:
            raise GradingError(sentence)
        yours = "\n\n".join(cell.source for cell in self._submissions.cells_of(line.strip()))
        programs = {"Yours": yours or "(No cell of yours was run since the kernel started.)", "Ours": ours}
        pages = [
            f'<div style="{_PAGE}"><b>{title}</b><pre style="{_LISTING}">{html.escape(text)}</pre></div>'
            for title, text in programs.items()
        ]
        plain = "\n\n".join(f"{title}:\n\n{text}" for title, text in programs.items())
        row = f'<div style="display: flex; flex-wrap: wrap; gap: 1em">{"".join(pages)}</div>'
        display({"text/plain": plain, "text/html": row}, raw=True)

    def grade_cells(self, exercise: str, seed: int | None = None, only: str = "") -> Report | None:
        """Grade what was last run in the exercise's `%%submission` cells; None when there were none."""
        from course_kit import grading
        from course_kit.grading.model.exercise import load_exercise

        load_exercise(exercise)  # says which there are, where there is no such
        cells = [
            nbformat.v4.new_code_cell(cell.source, execution_count=cell.number or None)
            for cell in self._submissions.cells_of(exercise)
        ]
        if not cells:
            return None
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "notebook.ipynb"
            nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
            report = grading.grade(exercise, path, seed=seed, only=only)
        shown = notebook_path().name or "this notebook"
        return replace(report, submission=report.submission.replace(str(path), shown))

    def report(self, exercise: str, seed: int | None = None) -> Report | None:
        """As `grade_cells`, but who asks again gets the same report until a `%%submission` cell is run again."""
        key = exercise, seed
        if key not in self._reports:
            self._reports[key] = self.grade_cells(exercise, seed)
        return self._reports[key]

    def _run_in_its_cell(self, first: str, cell: str) -> None:
        """Run the rest of a cell so that errors name the cell, and its lines as the notebook counts them."""
        after_it, self.shell.execution_count = self.shell.execution_count, self._number()
        self._within_cell = True
        try:
            self.shell.run_cell(cell if cell.startswith("%%") else f"# {first}{cell}")
        finally:
            self._within_cell = False
            self.shell.execution_count = after_it

    def _number(self) -> int:
        """The number of the running cell; `execution_count` is the next one's already, or not, with the version."""
        return len(self.shell.history_manager.input_hist_parsed) - 1

    def _before_cell(self, info: ExecutionInfo) -> None:
        if not self._within_cell:
            metadata = self._metadata()
            self._submissions.forget_cells(metadata.get("cellId"), info.raw_cell, metadata.get("deletedCells") or ())

    def _after_cell(self, result: ExecutionResult) -> None:
        if not self._within_cell:
            self._submissions.note_unmarked(result.info.raw_cell, result.execution_count or 0)

    def _metadata(self) -> dict[str, Any]:
        """What JupyterLab has sent with the cell."""
        parent: dict[str, Any] = getattr(self.shell, "get_parent", dict)()
        metadata: dict[str, Any] = parent.get("metadata", {})
        return metadata

    def _cell_id(self) -> str | None:
        # Graders name no cells; but they run each once, from top to bottom.
        in_an_autograder = f"cell {self.shell.execution_count}" if _in_an_autograder() else None
        return self._metadata().get("cellId", in_an_autograder)


def _require_mark(exercise: str, file: str) -> None:
    """Raise GradingError unless `%%submission` can name this exercise and this file."""
    from course_kit.grading.model.exercise import load_exercise

    if not exercise:
        raise GradingError(f"Name the exercise: %%submission EXERCISE. {the_exercises()}")
    files = load_exercise(exercise).files
    if file and not files:
        raise GradingError(f"{exercise} is one program: %%submission {exercise}")
    if files and not is_name(file):
        raise GradingError(f"Name the file: %%submission {exercise} FILE. The task asks for {', '.join(files)}.")


def magics_of_notebook(caller: str) -> GradeMagics:
    """The magics of the notebook we run in, for `caller`, a function that an instructor writes there."""
    shell = get_ipython()
    magics = shell.magics_manager.registry.get("GradeMagics") if shell else None
    if not isinstance(magics, GradeMagics):
        raise GradingError(
            f"{caller}() needs the notebook's submission. Put a locked cell above it with: %load_ext course_kit"
        )
    return magics


def nothing_from(exercise: str) -> str:
    """What to say where there is nothing to grade."""
    return f"Nothing was handed in: no cell that begins with %%submission {exercise} was run."


def _in_an_autograder() -> bool:
    """Whether nbgrader or Otter runs this notebook, and no person."""
    otter = getattr(sys.modules.get("otter"), "Notebook", None)
    return NBGRADER in os.environ or bool(getattr(otter, "_grading_mode", False))


def parse_line(line: str) -> tuple[str, str | None, dict[str, Any]]:
    """Exercise, file and options of a `%grade` line."""
    parser = MagicArgumentParser()
    parser.add_argument("exercise")
    parser.add_argument("file", nargs="?")
    parser.add_argument("--only", default="")
    parser.add_argument("--seed", type=int)
    options = vars(parser.parse_args(shlex.split(line)))
    return options.pop("exercise"), options.pop("file"), options


def the_exercises() -> str:
    """A sentence that names the exercises there are."""
    from course_kit.grading.model.exercise import list_exercise_ids

    try:
        return f"Exercises: {', '.join(list_exercise_ids())}."
    except GradingError as problem:
        return str(problem)
