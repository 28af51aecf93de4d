"""The lessons' steps: each check refuses a solution with a slip in it. nbval runs each lesson with the solutions."""

from __future__ import annotations

import re
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
NAMES = re.compile(r'^class (\w+)|^(\w+) = |__init__\("(\w+)"', re.MULTILINE)  # what a cell leaves behind
IMPORTS = """
import time
from threading import Event
from rclpy.action import ActionServer, CancelResponse
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
FIBONACCI = ("6f51471a", "104af7ba", "85fb217a")
OVEN = ("001c237f",)
COUNT = ("f09c89cf",)
SLIPS = {
    "drive": Slip('"x": 2.0', '"x": 0.5', "has to say x=2, y=1", ("robot",)),
    "bumper": Slip("< 0.5", "<= 0.5", "is True; it has to be False."),
    "clock": Slip("1.0", "0.1", "data is 0.1; it has to be 1.0."),
    "clock, too slow": Slip("0.5", "2.0", "Publish /ticks from a timer with a period of 0.5 s."),
    "clock, much too slow": Slip("0.5", "20.0", "Your node published nothing on /ticks within 3 s."),
    "subtract": Slip("request.a - request.b", "request.b - request.a", "sum is -2; it has to be 2.", ("ca380b89",)),
    "subtract, by the other's name": Slip(
        '"subtractor"', '"minimal_service"', "It subtracts, but minimal_service is gone", ("ca380b89",)
    ),
    "subtract, not started": Slip("Subtractor)", "Subtractor)\nSubtractor = Node", "an older class Subtractor"),
    "greet": Slip("response.success = True", "response.success = False", "success is False", PERSON),
    "too_old": Slip("<= 150", "<= 1500", "Your service accepted", PERSON),
    "where": Slip("self.here = message", "pass", "The robot is at x=0.5, y=0.0, and the message does not say so."),
    "where, without success": Slip("response.success = True", "pass", "success is False; it has to be True."),
    "succeed": Slip("goal_handle.succeed()", "goal_handle.abort()", "ABORTED", FIBONACCI),
    "short_orders": Slip("<= 20", "<= 21", "Your server accepted an order of 21.", FIBONACCI),
    "corner": Slip('"y": 2.0', '"y": 0.5', "has to say x=1, y=2", ("34cf6d0a", "5240fb15")),
    "countdown": Slip("order, -1, -1", "order, 0, -1", "sequence is [3, 2, 1]; it has to be [3, 2, 1, 0].", FIBONACCI),
    "radio": Slip("108.0", "180.0", "accepted", OVEN),
    "greeter": Slip('self.get_parameter("word").value', '"hello"', "has to say 'moin'", OVEN),
    "kettle": Slip("> 100.0", "> 1000.0", "accepted", ("ab90d110",)),
    "kettle, by a range": Slip("20.0", "20.0, between(0.0, 100.0, '')", "the word boil", (*OVEN, "ab90d110")),
    "lamp": Slip("Luck runs out", "Cursed", "does not contain the word luck", (*OVEN, "ab90d110")),
    "odometer": Slip('"odometer", 10', '"odometre", 10', "No node publishes /odometer."),
    "unload": Slip("goal.publish_feedback(", "print(", "No feedback says how far it is."),
    "belt": Slip("belt_speed", "speed", "Your node has not declared belt_speed."),
    "honk": Slip("response.success = True", "response.success = False", "success is False; it has to be True."),
    "home": Slip("x: 1.0", "x: 0.5", "has to say x=1, y=1", ("robot",)),
    "quick": Slip("2.5", "2.0", "max_velocity is 2.0; it has to be 2.5.", ("28a049d2",)),
    "second": Slip("add_two_ints:=sum", "add_two_ints:=total", "No service /sum", ("e1eb8744",)),
    "riddle": Slip("word discovery", "word riddle", "The visitor has no word yet.", ("11427637",)),
    "close": Slip('"closed: the fingers are 0 m apart"', '""', "say what was done"),
    "rest": Slip("if goal_handle.is_cancel_requested", "if False", "went on to its end", COUNT),
    "measure": Slip("str(problem)", '""', "its message is empty"),
    "robot_name": Slip("not change.value", "change.value is None", "accepted", ("0548236d", "cfbd3a1e")),
}


def notebook_of(lesson: str) -> nbformat.NotebookNode:
    return nbformat.read(NOTEBOOKS / f"{lesson}.ipynb", as_version=4)


ADDER = next(cell.source for cell in notebook_of("01_services").cells if cell.id == "ca380b89")


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


def test_what_follows_a_step_runs_where_nobody_has_done_it() -> None:
    for lesson in {step.lesson for step in STEPS.values()}:
        notebook = notebook_of(lesson)
        steps = {step.empty.id: step for step in lesson_steps.steps_of(notebook)}
        made_by_steps: set[str] = set()
        known = ""
        for cell in (one for one in notebook.cells if one.cell_type == "code" and "%check" not in one.source):
            if cell.id in steps:
                made_by_steps |= {name for pair in NAMES.findall(steps[cell.id].solution) for name in pair if name}
                continue
            needed = {name for name in made_by_steps if re.search(rf"\b{name}\b", cell.source)}
            assert all(re.search(rf"\b{name}\b", known) for name in needed), (lesson, needed, cell.source)
            known += cell.source


def test_every_step_has_a_slip() -> None:
    assert {name.partition(",")[0] for name in SLIPS} == set(STEPS)


@pytest.mark.parametrize("which", SLIPS)
def test_a_slip_is_found(which: str, kernel: Kernel) -> None:
    slip, name = SLIPS[which], which.partition(",")[0]
    step = STEPS[name]
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
    assert kernel.run(f"lab.stop()\n{ADDER}\n{cells_of('01_services')['subtract'].solution}").ok
    assert kernel.run("%check subtract").result["text/plain"].splitlines()[:3] == [
        "Right: /subtract_two_ints answers with a - b.",
        "  -> request /subtract_two_ints: a=5, b=3",
        "  <- response: sum=2",
    ]
    assert kernel.run(cells_of("00_welcome")["clock"].solution).ok
    assert kernel.run("%check clock").result["text/plain"].splitlines()[1] == "  <- /ticks: data=1.0"
    counted = kernel.run(
        "from course_kit.learner import progress; progress.read_progress()[0]['01_services/subtract'].passed"
    )
    assert counted.result["text/plain"] == "True"


def test_a_new_kernel_is_named_and_its_first_cell_may_run_twice(domain: int, tmp_path: Path) -> None:
    assert domain
    with Kernel(cwd=tmp_path) as new:
        for _ in range(2):
            said = new.run("%check subtract").result["text/plain"]
            assert said.startswith("The kernel has just been started and runs no node yet: run the notebook's first")
            assert "does not know lab yet: run the notebook's first" in new.run("lab.nodes()").stderr
            assert new.run("%grade move_robot").stderr.startswith("The kernel has just been started: run the cell that")
        for _ in range(2):
            assert new.run("%load_ext course_kit\nfrom course_kit import lab").stdout == ""
        assert new.run("%check subtract").result["text/plain"].startswith("Not yet: No service")


def test_what_is_not_there_is_named(kernel: Kernel) -> None:
    robot = "from course_kit.panels.demo_robot import DemoRobot\nlab.start(DemoRobot)"  # its action has hidden services
    honk = cells_of("04_choosing_a_pattern")["honk"].solution
    assert kernel.run(f"lab.stop()\nlab.stop_script()\n{robot}\n{honk}").ok
    said = kernel.run("%check subtract").result["text/plain"]
    none = "Not yet: No service /subtract_two_ints of type example_interfaces/srv/AddTwoInts is there."
    assert said.splitlines()[0] == none  # nothing there is written like it
    assert said.splitlines()[-1] == "  found: on the graph: /honk [std_srvs/srv/Trigger]"
    assert "found: on the graph: the nodes /demo_robot, /horn" in kernel.run("%check bumper").result["text/plain"]
    assert "There is no step 'substract'. Did you mean subtract?" in kernel.run("%check substract").error


def test_why_a_callback_answers_nothing_is_the_learners_to_read(kernel: Kernel) -> None:
    cells = {cell.id: cell.source for cell in notebook_of("01_services").cells}
    for one in PERSON:
        assert kernel.run(cells[one]).ok
    assert kernel.run(cells_of("01_services")["greet"].solution.replace("return response", "pass")).ok
    for _ in range(4):  # at each check, although the lab says the same three times at most
        checked = kernel.run("%check greet")
        assert checked.result["text/plain"] == "Not yet: greet of receptionist failed; the lines above say why."
        assert checked.stderr.startswith("receptionist: greet returned nothing. End it with `return response`.\n")
    assert kernel.run(cells_of("00_welcome")["clock"].solution.replace("1.0", "1")).ok
    said = kernel.run("%check clock").result["text/plain"].splitlines()  # what did not come is not said again
    assert said[1:] == ["  tick of clock failed; the lines above say why.", "     expected: a message on /ticks"]


def test_a_second_node_that_answers_is_named(kernel: Kernel) -> None:
    solution = cells_of("01_services")["subtract"].solution
    assert kernel.run(
        f"lab.stop()\n{ADDER}\n{solution}\n{solution.replace('Subtractor', 'Other').replace('subtractor', 'other')}"
    ).ok
    said = kernel.run("%check subtract").result["text/plain"]
    assert said.startswith("Not yet: 2 nodes have the service /subtract_two_ints")
    assert 'Yours are other, subtractor: lab.stop("other") stops one.' in said
    assert kernel.run('lab.stop("other")').ok
    assert kernel.run("%check subtract").result["text/plain"].startswith("Right: ")


def test_what_the_lab_publishes_itself_is_no_second_node(kernel: Kernel) -> None:
    cells = cells_of("00_welcome")
    assert kernel.run(f"lab.stop()\nlab.stop_script()\n{cells['clock'].solution}").ok
    assert kernel.run('lab.publish("/ticks", Float64, data=1.0)').ok
    assert kernel.run("%check clock").result["text/plain"].startswith("Right: ")
