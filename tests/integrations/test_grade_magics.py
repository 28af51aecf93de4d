"""`%%submission` and `%grade` in a real kernel, and the command beside them."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest

from course_kit.cli import main
from course_kit.integrations.submission_cells import SubmissionCells
from course_kit.learner import progress
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator

REPOSITORY = Path(__file__).resolve().parents[2]
pytestmark = pytest.mark.answers
SOLUTION = REPOSITORY / "solutions/temperature_service/temperature_service.py"


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    with Kernel(cwd=tmp_path_factory.mktemp("kernel")) as running:
        assert running.run("%load_ext course_kit").ok
        yield running


def test_the_cell_runs_as_usual_and_its_main_does_not(kernel: Kernel) -> None:
    done = kernel.run("%%submission temperature_service\n" + SOLUTION.read_text() + "\nprint(__name__)")
    assert done.ok
    assert done.stdout == "temperature_service\n"
    assert kernel.run("print(TemperatureService.__name__, __name__)").stdout == "TemperatureService __main__\n"


def test_a_magic_of_the_whole_cell_may_follow(kernel: Kernel) -> None:
    done = kernel.run("%%submission temperature_service\n%%capture said\nprint('aside')")
    assert (done.stdout, done.stderr) == ("", "")
    assert kernel.run("print(said.stdout)").stdout == "aside\n\n"


def test_the_card_shows_the_grade_and_the_text_says_the_same(kernel: Kernel) -> None:
    kernel.run("%%submission temperature_service\n" + SOLUTION.read_text())
    done = kernel.run("%grade temperature_service --seed 7")
    assert "10 of 10 points" in done.result["text/html"]
    assert "10 of 10 points" in done.result["text/plain"]
    assert "Submission: this notebook\n" in done.result["text/plain"]
    assert "Next: lesson 2, notebooks/02_actions.ipynb; then exercise 2, move_robot." in done.stdout
    assert 'href="../../notebooks/02_actions.ipynb"' in done.result["text/html"]


def test_one_part_alone_is_graded_and_counts_as_that(kernel: Kernel) -> None:
    kernel.run("%%submission temperature_service\n" + SOLUTION.read_text())
    done = kernel.run("%grade temperature_service --only celsius")
    assert "1.5 of 1.5 points, celsius alone" in done.result["text/plain"]  # with "offered", which it needs
    assert "1.5 of 1.5 points</strong>,\n  celsius alone" in done.result["text/html"]
    assert "Next" not in done.stdout
    refusal = "There is no part 'dor'. The checks are: offered, "
    assert refusal in kernel.run("%grade temperature_service --only dor").stderr


def test_a_drill_names_its_fault_at_the_second_try_and_shows_the_solution_once_it_is_solved(
    kernel: Kernel, tmp_path: Path
) -> None:
    kernel.run(f"import os\nos.environ['{progress.VARIABLE}'] = {str(tmp_path / 'progress.json')!r}")
    folder = SOLUTION.parent.parent.parent / "exercises/drills/dark_lamp"
    kernel.run("%%submission dark_lamp\n" + (folder / "dark_lamp.py").read_text())
    first = kernel.run("%grade dark_lamp")
    assert "Look at the symptom again" in first.stdout
    assert not first.result
    assert "Float32" in kernel.run("%grade dark_lamp").result["text/plain"]
    assert "You can see the solution once you have passed" in kernel.run("%solution dark_lamp").stderr
    kernel.run("%%submission dark_lamp\n" + (folder / "solution/dark_lamp.py").read_text())
    assert "PASS  The lamp hears the slider" in kernel.run("%grade dark_lamp").result["text/plain"]
    shown = kernel.run("%solution dark_lamp").result
    assert shown["text/plain"].startswith("Yours:\n\n%%submission dark_lamp\n")
    assert '<b>Ours</b><pre style="white-space: pre;' in shown["text/html"]
    kernel.run(f"os.environ['{progress.VARIABLE}'] = 'off'")


def test_who_grades_a_file_as_root_is_told_so_beforehand(kernel: Kernel) -> None:
    """Also where there is nothing to grade, so not after it. The notebook's own cells have run as root anyway."""
    done = kernel.run("%grade temperature_service no.py")
    assert done.stderr.startswith("You are grading as root. Use an ordinary account") == (os.geteuid() == 0)
    assert "root" not in kernel.run("%grade temperature_service").stderr


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("", "Use it as %grade EXERCISE"),
        ("temperature_service --seed", "Use it as %grade EXERCISE"),
        ("temprature_service", "temperature_service"),
        ('temperature_service "unclosed', "Use it as %grade EXERCISE"),
    ],
)
def test_a_slip_gets_a_sentence_and_no_traceback(kernel: Kernel, line: str, sentence: str) -> None:
    done = kernel.run(f"%grade {line}")
    assert done.ok
    assert sentence in done.stderr


def sources(cells: SubmissionCells, exercise: str = "exercise") -> list[str]:
    return [cell.source for cell in cells.cells_of(exercise)]


def test_cells_of_a_submission_are_joined_in_the_notebooks_order(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    cells = SubmissionCells()
    cells.keep("exercise", "second", "b")
    cells.keep("exercise", "first", "a")
    assert sources(cells) == ["b", "a"]  # the order of running, while the notebook is not known
    made = [nbformat.v4.new_code_cell(id=cell_id) for cell_id in ("first", "second")]
    nbformat.write(nbformat.v4.new_notebook(cells=made), tmp_path / "notebook.ipynb")
    monkeypatch.setenv("JPY_SESSION_NAME", str(tmp_path / "notebook.ipynb"))
    assert sources(cells) == ["a", "b"]
    cells.keep("exercise", "second", "new b")
    assert sources(cells) == ["a", "new b"]


def test_below_the_pass_mark_the_command_ends_with_1_and_shows_the_first_hint(
    capsys: pytest.CaptureFixture[str],
) -> None:
    starter = REPOSITORY / "exercises/temperature_service/temperature_service.py"
    assert main.main(["grade", "temperature_service", str(starter)]) == 1
    said = capsys.readouterr().out
    assert "hint" in said
    assert max(map(len, said.splitlines())) <= 80


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["grade", "temperature_service", str(SOLUTION), "--attach"], "Name one thing to grade"),
        (["grade", "temprature_service", "file.py"], "Did you mean temperature_service?"),
        (["watch", "temprature_service"], "Did you mean temperature_service?"),
        ([], "COMMAND"),
    ],
)
def test_what_cannot_be_done_is_said_in_a_sentence_and_ends_with_2(
    arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with contextlib.suppress(SystemExit):
        assert main.main(arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert sentence in said.err
