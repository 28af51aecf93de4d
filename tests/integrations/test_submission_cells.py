"""Which `%%submission` cells count, in a real kernel that is told of its cells as JupyterLab tells it."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING

import nbformat
import pytest

from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

EXERCISE = "pattern_choice"  # the one that is graded fastest
MARK = f"%%submission {EXERCISE}\n"
CELL = f"{MARK}class Answers:\n    pass\n\nanswers = {{}}"
FORGET = "%load_ext course_kit\nget_ipython().magics_manager.registry['GradeMagics']._submissions.__init__()"
NOTHING = f"run the cell that begins with %%submission {EXERCISE}"


@pytest.fixture(scope="module")
def _one(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    folder = tmp_path_factory.mktemp("kernel")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("JPY_SESSION_NAME", str(folder / "notebook.ipynb"))
        with Kernel(cwd=folder) as running:
            yield running


@pytest.fixture
def kernel(_one: Kernel) -> Kernel:
    (_one.cwd / "notebook.ipynb").unlink(missing_ok=True)
    assert _one.run(FORGET).ok
    return _one


def save(kernel: Kernel, **cells: str) -> None:
    """Save the notebook, after whatever was run."""
    path: Path = kernel.cwd / "notebook.ipynb"
    made = [nbformat.v4.new_code_cell(source, id=cell_id) for cell_id, source in cells.items()]
    nbformat.write(nbformat.v4.new_notebook(cells=made), path)
    later = path.stat().st_mtime + 2
    os.utime(path, (later, later))


def grade(kernel: Kernel, *deleted: str) -> tuple[str, str]:
    shown = kernel.run(f"%grade {EXERCISE}", cellId="grade", deletedCells=list(deleted))
    return shown.stdout, shown.stderr


def number(kernel: Kernel) -> str:
    return kernel.run("print(len(In) - 1)").stdout.strip()


def test_it_says_which_cells_it_grades_and_when_they_ran(kernel: Kernel) -> None:
    before = int(number(kernel))
    kernel.run(CELL, cellId="one")
    kernel.run(f"{MARK}more = 1", cellId="two")
    said, warned = grade(kernel)
    time = r"run at \d\d:\d\d:\d\d"
    assert re.fullmatch(rf"Grading In\[{before + 1}\], {time}; In\[{before + 2}\], {time}\. This takes .*\n", said)
    assert warned == ""


def test_a_deleted_cell_does_not_count_whether_the_notebook_was_saved_or_not(kernel: Kernel) -> None:
    kernel.run(CELL, cellId="one")
    assert NOTHING in grade(kernel, "one")[1]
    kernel.run(CELL, cellId="one")
    kernel.run(f"{MARK}more = 1", cellId="two")
    save(kernel, two=f"{MARK}more = 1")
    assert grade(kernel)[0].count("In[") == 1


def test_a_marked_cell_that_was_not_run_is_graded_as_in_a_class_and_told(kernel: Kernel) -> None:
    save(kernel, old=CELL, one=CELL, note="%%submission temperature_service")
    kernel.run(CELL, cellId="one")
    said, warned = grade(kernel)
    assert said.startswith("Grading a cell that was not run; In[")
    assert "It was graded, too, as it would be in a class." in warned
    os.utime(kernel.cwd / "notebook.ipynb", (1, 1))
    kernel.run("answers = {}", cellId="old")  # has lost its mark, and the file does not show it yet
    assert grade(kernel)[1] == ""


def test_an_edited_cell_is_warned_of(kernel: Kernel) -> None:
    kernel.run(CELL, cellId="one")
    save(kernel, one=CELL)
    assert grade(kernel)[1] == ""
    save(kernel, one=f"{CELL}\nmore = 1")
    assert "was edited after you ran it" in grade(kernel)[1]
    assert "Run it again to have the change graded." in grade(kernel)[1]


def test_a_class_defined_again_without_the_mark_is_warned_of(kernel: Kernel) -> None:
    kernel.run(CELL, cellId="one")
    kernel.run("class Answers:\n    better = True", cellId="two")
    place = int(number(kernel)) - 1
    said = f"In[{place}] defines Answers again, without %%submission {EXERCISE} in its first line: it is not graded."
    assert said in grade(kernel)[1]
    kernel.run(CELL, cellId="one")
    assert grade(kernel)[1] == ""


def test_errors_name_the_right_cell_and_line(kernel: Kernel) -> None:
    shown = kernel.run(f"{MARK}x = 1\ny = 1 / 0", cellId="one")
    place = int(number(kernel)) - 1
    assert f"In[{place}], line 3" in re.sub(
        r"\x1b\[[0-9;]*m|Cell |\s", lambda hit: " " if hit[0] == " " else "", shown.error
    )


def test_after_a_restart_magics_load_the_course_and_each_name_says_what_to_run(tmp_path: Path) -> None:
    with Kernel(cwd=tmp_path) as fresh:
        fresh.run("import os; os.environ['JPY_SESSION_NAME'] = os.path.abspath('notebook.ipynb')")
        save(fresh, above="first, second = 1, 2", one=CELL)
        for name in ("lab", "first", "second", "Answers"):
            assert "run the notebook's first code cell" in fresh.run(name).stderr
        assert fresh.run("nowhere").stderr == ""
        fresh.run(CELL, cellId="one")
        assert grade(fresh)[0].startswith("Grading In[7], run at ")


def test_a_pasted_program_that_spins_says_so_where_nothing_is_loaded_and_stops_as_one_line(tmp_path: Path) -> None:
    with Kernel(cwd=tmp_path) as fresh:
        message = fresh.send("import rclpy\nrclpy.init()\nnode = rclpy.create_node('pasted')\nrclpy.spin(node)")
        shown = fresh.finish(message, until="in the background instead.")
        assert "rclpy.spin(): this cell runs pasted until you press Stop" in shown.stdout
        fresh.manager.interrupt_kernel()
        stopped = fresh.finish(message)
        assert stopped.error == "Interrupted in In[1], line 4."
        assert "pasted, which the lab did not run, is gone" in stopped.stdout
