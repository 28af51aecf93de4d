"""Two notebooks on one graph, each in a real kernel. Cells save programs by name: theirs are nobody else's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from tests.lab.kernel import Kernel
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

FIRST, SECOND = "02_actions.ipynb", "exercise.ipynb"
SERVER = """
from rclpy.node import Node
from std_srvs.srv import Trigger
from std_msgs.msg import String

class {name}(Node):
    def __init__(self):
        super().__init__("{node}")
        self.create_service(Trigger, "ask", self.answer)

    def answer(self, request, response):
        response.message = "{node}"
        return response
"""


@pytest.fixture(scope="module")
def _two(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Kernel, Kernel]]:
    folder = tmp_path_factory.mktemp("notebooks")
    with environment.exclusive_domain() as domain_id, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain_id))
        patch.setenv("JPY_SESSION_NAME", str(folder / FIRST))
        with Kernel(cwd=folder) as first:
            patch.setenv("JPY_SESSION_NAME", str(folder / SECOND))
            with Kernel(cwd=folder) as second:
                for one in (first, second):
                    assert one.run(
                        "%load_ext course_kit\nfrom course_kit import lab\nlab.nodes()\nlab.current().engine"
                    ).ok
                yield first, second


@pytest.fixture
def two(_two: tuple[Kernel, Kernel]) -> tuple[Kernel, Kernel]:
    for one in _two:
        assert one.run("lab.stop()\nlab.stop_script()").ok
    wait_until(lambda: not others(_two[1]) and not others(_two[0]), "two empty notebooks")
    return _two


def others(kernel: Kernel) -> list[str]:
    """What a notebook knows of others: a line each."""
    return kernel.run("for one in lab.others(): print(one)").stdout.splitlines()


def start(kernel: Kernel, name: str, node: str) -> str:
    """Start a server; what was said, also by and by, until another cell is run."""
    shown = kernel.run(SERVER.format(name=name, node=node) + f"started = lab.start({name})")
    assert shown.ok, shown.error
    return shown.stdout


def test_a_renamed_notebook_has_its_new_name_for_the_others(two: tuple[Kernel, Kernel]) -> None:
    """The page tells the kernel. A script that runs goes on with the mark it has, and is still this notebook's."""
    first, second = two
    program = f"{SERVER.format(name='Old', node='old')}\nimport rclpy\nrclpy.init()\nrclpy.spin(Old())"
    assert first.run(f"%%ros_script old\n{program}").ok
    start(first, "Robot", "robot")
    wait_until(lambda: others(second) == [f"{FIRST}: old, robot"], lambda: others(second))
    for new in ("mine.ipynb", FIRST):
        assert first.run(f"lab.current().rename_notebook({new!r})").ok
        wait_until(lambda new=new: others(second) == [f"{new}: old, robot"], lambda: others(second))
        assert others(first) == []
    second.run("lab.stop_others()")
    wait_until(lambda: others(second) == [], lambda: others(second))


def test_what_another_notebook_publishes_itself_is_drawn(two: tuple[Kernel, Kernel]) -> None:
    first, second = two
    start(first, "Robot", "robot")
    assert first.run("started.create_subscription(String, 'told', print, 1)\nlab.publish('/told', String, data='')").ok
    look, drawn = "from course_kit import panels\nprint(panels.graph())", f"lab of {FIRST}\n    publishes /told ["
    wait_until(lambda: drawn in second.run(look).stdout, lambda: second.run(look).stdout)
    assert "No node" not in second.run(look).stdout


def test_a_notebook_that_is_opened_lists_the_nodes_of_others_in_its_first_cell(
    two: tuple[Kernel, Kernel], tmp_path: Path
) -> None:
    start(two[0], "Robot", "robot")
    with Kernel(cwd=tmp_path) as opened:
        shown = opened.run("%load_ext course_kit\nfrom course_kit import lab\nlab.nodes()").result["text/plain"]
    assert shown.endswith(f"lab.\nIn other notebooks (lab.stop_others() stops them):\n    {FIRST}: robot")
    with Kernel(cwd=tmp_path) as opened:
        stopped = opened.run("%load_ext course_kit\nfrom course_kit import lab\nlab.stop_others()\nlab.stop_others()")
        assert "robot.\nStopped: nothing, for no other notebook has nodes.\n" in stopped.stdout, stopped.error
    assert two[0].run("lab.nodes()").result["text/plain"] == "No node is running in the lab."


def test_a_name_that_another_notebook_offers_is_told_at_the_start(two: tuple[Kernel, Kernel]) -> None:
    first, second = two
    start(first, "Robot", "robot")
    wait_until(lambda: others(second), "the robot")
    said = start(second, "Mine", "mine")
    assert said == (
        f"/ask is also offered by robot of {FIRST}: both answer every request. "
        "lab.stop_others() stops what other notebooks run.\n"
    )


def test_an_own_script_that_offers_the_name_is_called_so(two: tuple[Kernel, Kernel]) -> None:
    _, second = two
    program = SERVER.format(name="Robot", node="robot")
    spins = "import rclpy\nrclpy.init()\nrclpy.spin(Robot())"
    assert "in the background" in second.run(f"%%ros_script neighbour\n{program}\n{spins}").stdout
    assert "/ask is also offered by robot of your script neighbour" in start(second, "Mine", "mine")


def test_an_answer_from_another_notebook_is_told_once(two: tuple[Kernel, Kernel]) -> None:
    first, second = two
    start(first, "Robot", "robot")
    wait_until(lambda: others(second), "the robot")
    call = "from std_srvs.srv import Trigger\nprint((await lab.call('/ask', Trigger)).message)"
    said = (
        f"/ask is answered by robot of {FIRST}, not by a node of this notebook. "
        "lab.stop_others() stops what other notebooks run.\n"
    )
    assert second.run(call).stdout == f"{said}robot\n"
    assert second.run(call).stdout == "robot\n"
    assert first.run(call).stdout == "robot\n"


def test_others_are_stopped_with_their_scripts_and_told_so(two: tuple[Kernel, Kernel]) -> None:
    first, second = two
    start(first, "Robot", "robot")
    program = SERVER.format(name="Robot", node="program").replace('"ask"', '"other"')
    first.run(f"%%ros_script neighbour\n{program}\nimport rclpy\nrclpy.init()\nrclpy.spin(Robot())")
    wait_until(lambda: others(second) == [f"{FIRST}: program, robot"], lambda: others(second))
    stopped = second.run("lab.stop_others()\nprint(lab.others())")
    assert stopped.stdout == f"Stopped: {FIRST}: program, robot.\n[]\n", stopped.error
    assert first.run("lab.nodes()").result["text/plain"] == "No node is running in the lab."
    wait_until(lambda: not first.run("for _ in lab.current().scripts._running: print(_)").stdout, "the script's end")


def test_what_notebooks_tell_each_other_is_on_no_list_of_topics(two: tuple[Kernel, Kernel]) -> None:
    listed = two[0].run("%ros2 topic list --include-hidden-topics").stdout
    assert "/rosout" in listed
    assert "_lab" not in listed
