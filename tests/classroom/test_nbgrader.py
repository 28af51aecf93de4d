"""A real nbgrader course with one of our exercises: made, handed out, handed in, and graded by nbgrader's commands."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest

from course_kit import environment, grading, nbgrader

REPOSITORY = Path(__file__).resolve().parent.parent.parent
EXERCISE = "temperature_service"
SOLUTION = REPOSITORY / f"solutions/{EXERCISE}/{EXERCISE}.py"
BROKEN = REPOSITORY / f"tests/broken/{EXERCISE}"
PARTIAL = BROKEN / "validation.missing.py"
MARK = f"%%submission {EXERCISE}\n"
PATIENCE_S = 150.0  # against hanging only
CONFIG = """
c = get_config()
c.CourseDirectory.course_id = "ros"
c.Execute.timeout = 120
"""
# A learner's node that goes on talking on both streams while the test cell runs.
CHATTER = """
import sys
from course_kit import lab
from rclpy.node import Node

class Chatter(Node):
    def __init__(self):
        super().__init__("chatter")
        self.create_timer(0.01, self.chat)
    def chat(self):
        self.get_logger().warn("log line")
        print("error line", file=sys.stderr)

lab.start(Chatter)
"""
pytestmark = [pytest.mark.answers, pytest.mark.timeout(240)]


def run(course: Path, *words: str) -> None:
    """One of nbgrader's commands; it calls other commands of its environment by their names."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    private = {name: str(course / "jupyter") for name in ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "IPYTHONDIR")}
    done = subprocess.run(
        [sys.executable, "-m", "nbgrader", *words],
        cwd=course,
        env=environment.child_environment(PATH=path, **private),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def role(name: str, **more: Any) -> dict[str, Any]:
    plain = {"grade": False, "solution": False, "locked": False, "task": False, "schema_version": 3}
    return {"nbgrader": {**plain, "grade_id": name, **more}}


def source_notebook() -> Any:
    """Our exercise's notebook as an instructor prepares it for nbgrader."""
    notebook = nbformat.read(REPOSITORY / f"exercises/{EXERCISE}/{EXERCISE}.ipynb", as_version=4)
    cells = {cell["id"]: cell for cell in notebook.cells}
    cells["load"].metadata.update(role("load", locked=True))
    answer = cells["answer"]
    answer.metadata.update(role("answer", solution=True))
    answer.source = answer.source.replace(
        "# Your code goes here.", "### BEGIN SOLUTION\n        response.success = True\n        ### END SOLUTION"
    )
    cells["grade"].source = f'from course_kit import nbgrader\n\nnbgrader.points("{EXERCISE}", seed=1)'
    cells["grade"].metadata.update(role("checks", grade=True, locked=True, points=10))
    # What a learner tries in between is tested elsewhere.
    notebook.cells = [cell for cell in notebook.cells if cell["id"] not in {"type", "start", "call"}]
    return notebook


def hand_in(course: Path, student: str, *programs: str) -> None:
    """The released notebook with `programs` as answer cells."""
    notebook = nbformat.read(course / f"release/services/{EXERCISE}.ipynb", as_version=4)
    place = next(n for n, cell in enumerate(notebook.cells) if cell.source.startswith(MARK))
    assert "raise NotImplementedError" in notebook.cells[place].source
    first, *rest = programs
    notebook.cells[place].source = first
    notebook.cells[place + 1 : place + 1] = [nbformat.v4.new_code_cell(program) for program in rest]
    folder = course / f"submitted/{student}/services"
    folder.mkdir(parents=True)
    nbformat.write(notebook, folder / f"{EXERCISE}.ipynb")


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The course after `nbgrader autograde`."""
    folder = tmp_path_factory.mktemp("course")
    (folder / "nbgrader_config.py").write_text(CONFIG)
    (folder / "source/services").mkdir(parents=True)
    nbformat.write(source_notebook(), folder / f"source/services/{EXERCISE}.ipynb")
    imports, program = SOLUTION.read_text().split("class TemperatureService", maxsplit=1)
    with environment.exclusive_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        patch.delenv("PYTEST_CURRENT_TEST", raising=False)  # with it kernels do not look at what C code prints
        run(folder, "generate_assignment", "services")
        # nbgrader names no cells to the kernel; two of them have to be joined all the same.
        hand_in(folder, "full", MARK + imports, f"{MARK}class TemperatureService{program}", CHATTER)
        hand_in(folder, "partial", MARK + PARTIAL.read_text())
        hand_in(folder, "empty", "print('I have deleted the cell')")
        run(folder, "autograde", "services")
    return folder


def graded(course: Path, student: str) -> Any:
    notebook = nbformat.read(course / f"autograded/{student}/services/{EXERCISE}.ipynb", as_version=4)
    return next(cell for cell in notebook.cells if cell.metadata.get("nbgrader", {}).get("grade_id") == "checks")


@pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning")  # nbgrader's own way with its database
def test_the_gradebook_has_the_graders_points(course: Path) -> None:
    partial = grading.grade(EXERCISE, PARTIAL, seed=1).score
    assert 0 < partial < 10
    expected = {"full": 10.0, "partial": partial, "empty": 0.0}
    from nbgrader.api import Gradebook  # so large that each worker would feel it

    with Gradebook(f"sqlite:///{course / 'gradebook.db'}") as gradebook:
        for student, score in expected.items():
            assert gradebook.find_grade("checks", EXERCISE, "services", student).auto_score == score, student


def test_the_cell_shows_the_feedback_and_writes_no_error(course: Path) -> None:
    for student, sentence in {
        "full": "10 of 10 points",
        "partial": "NaN and infinity are refused with a reason",
        "empty": "Nothing was handed in",
    }.items():
        outputs = graded(course, student).outputs
        assert sentence in "".join(output.get("text", "") for output in outputs), student
        assert {(output.output_type, output.get("name")) for output in outputs} == {
            ("stream", "stdout"),
            ("execute_result", None),
        }, student


def test_a_node_that_was_left_running_costs_nothing(course: Path) -> None:
    text = "".join(output.get("text", "") for output in graded(course, "full").outputs)
    assert "log line" in text
    assert "error line" in text


@pytest.mark.parametrize(
    ("score", "most", "points"),
    [(10.0, 10.0, "10"), (8.5, 10.0, "8.5"), (8.5, 4, "3.4"), (0.0, 4, "0"), (1.0, 3, "0.3")],
)
def test_points_are_those_of_the_cell_and_print_as_a_number(score: float, most: float, points: str) -> None:
    assert repr(nbgrader.scale_score(score, 10.0, most)) == points
