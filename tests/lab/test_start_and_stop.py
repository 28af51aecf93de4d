from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from course_kit import lab
from tests.lab.nodes import Faulty, Switch, Talker

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab

pytestmark = pytest.mark.usefixtures("own_lab")


def names_on_graph(of: Lab) -> list[str]:
    return sorted(name for name, _ in of.engine.node.get_node_names_and_namespaces() if not name.startswith("_lab"))


def redefined(label: str, name: str = "switch") -> type[Node]:
    """The class `Cell` as a cell defines it anew: another object of the same name."""

    class Cell(Switch):
        def __init__(self) -> None:
            super().__init__(name, label)

    return Cell


def test_a_tutorials_node_runs_in_the_labs_context(own_lab: Lab) -> None:
    node = lab.start(Switch)
    assert node.context is own_lab.engine.executor_thread.context
    assert lab.call_blocking("/switch", SetBool, data=True).message == "first"
    assert node.ok is True  # rclpy.ok() inside the callback


def test_the_same_start_again_replaces_the_node(own_lab: Lab) -> None:
    first = lab.start(Switch)
    second = lab.start(Switch)
    assert names_on_graph(own_lab) == ["switch"]
    for _ in range(20):
        lab.call_blocking("/switch", SetBool)
    assert (first.answers, second.answers) == (0, 20)


def test_a_class_defined_again_replaces_the_node_of_the_old_class_under_any_name(own_lab: Lab) -> None:
    lab.start(redefined("old", name="switch"))
    lab.start(redefined("new", name="renamed"))
    assert names_on_graph(own_lab) == ["renamed"]
    assert lab.call_blocking("/switch", SetBool).message == "new"


def test_another_class_with_the_same_node_name_replaces(own_lab: Lab) -> None:
    lab.start(Talker)
    lab.start(Switch, name="talker")
    assert names_on_graph(own_lab) == ["talker"]
    assert [live.node_class for live in lab.nodes()] == [Switch]


def test_the_old_node_is_gone_before_the_new_one_is_made(own_lab: Lab) -> None:
    seen: list[list[str]] = []

    class Watching(Node):
        def __init__(self) -> None:
            seen.append(names_on_graph(own_lab))
            super().__init__("watching")

    lab.start(Watching)
    lab.start(Watching)
    assert seen == [[], []]


def test_a_name_from_a_remapping_replaces_too(own_lab: Lab) -> None:
    class Remapped(Node):
        def __init__(self) -> None:
            super().__init__("plain", cli_args=["--ros-args", "-r", "__node:=switch"])

    lab.start(Switch)
    lab.start(Remapped)
    assert names_on_graph(own_lab) == ["switch"]
    assert [live.node_class for live in lab.nodes()] == [Remapped]


def test_an_init_that_raises_leaves_nothing(own_lab: Lab) -> None:
    class Half(Node):
        def __init__(self) -> None:
            super().__init__("half")
            self.create_service(Trigger, "half", lambda _, response: response)
            self.helper = rclpy.create_node("helper")
            raise ValueError("no map")

    with pytest.raises(ValueError, match="no map"):
        lab.start(Half)
    assert names_on_graph(own_lab) == []
    assert list(lab.nodes()) == []
    lab.start(Switch)
    assert lab.call_blocking("/switch", SetBool).message == "first"


@pytest.mark.parametrize("how", ["node", "class", "name", "all"])
def test_stop(how: str, own_lab: Lab) -> None:
    node = lab.start(Switch)
    lab.start(Talker)
    targets: dict[str, tuple[Any, ...]] = {"node": (node,), "class": (Switch,), "name": ("switch",), "all": ()}
    lab.stop(*targets[how])
    assert names_on_graph(own_lab) == ([] if how == "all" else ["talker"])


def test_a_callback_that_never_ends_is_stopped_with_its_node() -> None:
    class Stuck(Node):
        def __init__(self) -> None:
            super().__init__("stuck")
            self.create_timer(0.001, self.tick)

        def tick(self) -> None:
            while True:
                pass

    stuck = lab.start(Stuck)
    lab.stop(stuck)
    lab.start(Switch)
    assert lab.call_blocking("/switch", SetBool).message == "first"


def test_nodes_prints_what_each_offers() -> None:
    assert repr(lab.nodes()) == "No node is running in the lab."
    lab.start(Talker)
    lab.start(Switch)
    assert repr(lab.nodes()) == (
        "switch (Switch)\n    serves /switch [std_srvs/srv/SetBool]\n"
        "talker (Talker)\n    publishes /count [std_msgs/msg/String]"
    )


@pytest.mark.parametrize(
    ("given", "message"),
    [(int, "int is not a class of nodes"), ("switch", "'switch' is not a class"), (print, "print is not a class")],
)
def test_what_is_no_node_class(given: Any, message: str) -> None:
    with pytest.raises(lab.LabError, match=message):
        lab.start(given)


def test_a_node_instead_of_a_class(own_lab: Lab) -> None:
    assert own_lab.engine
    node = Switch()
    with pytest.raises(lab.LabError, match=r"lab\.start\(Switch\)"):
        lab.start(node)  # type: ignore[type-var]
    node.destroy_node()


@pytest.mark.parametrize("uses_node", [True, False])
def test_a_class_that_forgets_super_init(uses_node: bool) -> None:
    class Forgetful(Node):
        def __init__(self) -> None:
            if uses_node:
                self.create_service(Trigger, "x", print)

    with pytest.raises(lab.LabError, match=r"Forgetful.__init__ has to call super\(\).__init__"):
        lab.start(Forgetful)


def test_closing_puts_rclpy_back(own_lab: Lab) -> None:
    lab.start(Switch)
    patched = rclpy.init
    own_lab.close()
    assert rclpy.init is not patched
    assert not rclpy.ok()


def test_a_program_ends_cleanly_while_callbacks_run(domain: int) -> None:
    assert domain
    program = (
        "from course_kit import lab\n"
        "from tests.lab.nodes import Talker, Faulty\n"
        "lab.start(Talker)\nlab.start(Faulty)\nprint('end', flush=True)\n"
    )
    for _ in range(3):
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
        assert (ended.returncode, ended.stdout, ended.stderr) == (0, "end\n", "")
    assert Faulty


def test_a_stop_of_everything_takes_the_labs_own_clients_off_the_graph(own_lab: Lab) -> None:
    lab.start(Switch)
    lab.call_blocking("/switch", SetBool)
    with pytest.raises(lab.ServiceNotFoundError):
        lab.call_blocking("/swich", SetBool, timeout=0.1)
    lab.publish("/somewhere", String, data="")
    lab.stop()
    node = own_lab.engine.node
    assert {"/switch", "/swich"}.isdisjoint(name for name, _ in node.get_service_names_and_types())
    assert "/somewhere" not in dict(node.get_topic_names_and_types())
    lab.start(Switch)
    assert lab.call_blocking("/switch", SetBool, data=True).success
