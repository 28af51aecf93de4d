"""The lessons' steps: each check refuses a solution with a slip in it. nbval runs each lesson with the solutions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import nbformat
import pytest

from course_kit import environment
from course_kit.dev import lesson_steps
from course_kit.learner.steps import STEPS
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator

NOTEBOOKS = Path(__file__).resolve().parent.parent.parent / "notebooks"
FEWEST, MOST = 3, 5  # steps of a lesson
IMPORTS = """
from rclpy.node import Node
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import Trigger
from example_interfaces.srv import AddTwoInts
"""


class Slip(NamedTuple):
    """A wrong program: the solution with something replaced, after cells of the lesson that it needs."""

    right: str
    wrong: str
    says: str
    cells: tuple[str, ...] = ()


PERSON = ("9c831d96", "f5c2dbc9")
SLIPS = {
    "subtract": Slip("request.a - request.b", "request.b - request.a", "sum has to be 2, and is -2."),
    "greet": Slip("response.success = True", "response.success = False", "success has to be True", PERSON),
    "too_old": Slip("<= 150", "<= 1500", "Your service accepted", PERSON),
    "triple": Slip("3 * ", "2 * ", "sum has to be 42, and is 28."),
}


def notebook_of(lesson: str) -> nbformat.NotebookNode:
    return nbformat.read(NOTEBOOKS / f"{lesson}.ipynb", as_version=4)


def cells_of(lesson: str) -> dict[str, lesson_steps.StepCells]:
    return {one.name: one for one in lesson_steps.steps_of(notebook_of(lesson))}


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    with environment.exclusive_domain() as domain_id, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain_id))
        folder = tmp_path_factory.mktemp("kernel")
        patch.setenv("COURSE_KIT_PROGRESS", str(folder / "progress.json"))
        with Kernel(cwd=folder) as running:
            assert running.run(f"%load_ext course_kit\nfrom course_kit import lab, panels\n{IMPORTS}").ok
            yield running


@pytest.mark.parametrize("lesson", sorted({step.lesson for step in STEPS.values()}))
def test_a_lesson_has_its_steps_each_with_an_empty_cell_a_check_a_hint_and_a_solution(lesson: str) -> None:
    found = cells_of(lesson)
    assert list(found) == [step.name for step in STEPS.values() if step.lesson == lesson]
    assert FEWEST <= len(found) <= MOST
    for step in found.values():
        assert all(line.startswith("#") for line in step.empty.source.splitlines())
        assert [*step.empty.outputs, *step.check.outputs] == []
        assert "<summary>A hint</summary>" in step.fold.source
        assert step.solution


def test_every_step_has_a_slip() -> None:
    assert set(SLIPS) == set(STEPS)


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_is_found(name: str, kernel: Kernel) -> None:
    slip, step = SLIPS[name], STEPS[name]
    assert kernel.run("lab.stop()\nlab.stop_script()").ok
    cells = {cell.id: cell.source for cell in notebook_of(step.lesson).cells}
    solution = cells_of(step.lesson)[name].solution
    assert slip.right in solution
    for source in (*(cells[one] for one in slip.cells), solution.replace(slip.right, slip.wrong)):
        ran = kernel.run(source)
        assert ran.ok, ran.error
    said = kernel.run(f"%check {name}").result["text/plain"]
    assert said.startswith("Not yet: ")
    assert slip.says in said


def test_a_check_shows_what_was_sent_and_what_came_and_is_counted(kernel: Kernel) -> None:
    assert kernel.run(f"lab.stop()\n{cells_of('01_services')['triple'].solution}").ok
    assert kernel.run("%check triple").result["text/plain"].splitlines()[:3] == [
        "Right: `/triple` answers with three times `a`.",
        "  -> request /triple: a=14, b=0",
        "  <- response: sum=42",
    ]
    counted = kernel.run("from course_kit.learner import progress; progress.read()[0]['01_services/triple'].passed")
    assert counted.result["text/plain"] == "True"


def test_what_is_not_there_is_named(kernel: Kernel) -> None:
    assert kernel.run("lab.stop()").ok
    said = kernel.run("%check triple").result["text/plain"]
    assert said.startswith("Not yet: No service /triple of type example_interfaces/srv/AddTwoInts is there.")
    assert "There is no step 'tripel'. Did you mean triple?" in kernel.run("%check tripel").error
