"""The picture of the ROS graph: what it shows, that it follows, that it ends."""

from __future__ import annotations

import itertools
import re
import threading
import time
from typing import TYPE_CHECKING, Any

import pytest
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

from course_kit import lab, panels
from course_kit.lab.runtime.neighbours import OtherNotebook
from course_kit.panels.base import RATE
from course_kit.panels.graph_view import GraphView, GraphWidget, in_lines, news, notebooks_by_node
from course_kit.ros import graph as overview
from course_kit.ros.graph_drawing import boxes_of, graph_svg
from tests.waiting import wait_until

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab
    from course_kit.ros.graph import Overview

pytestmark = pytest.mark.usefixtures("live_lab")
LEAST_ZOOM = float(re.findall(r"READABLE_DOCKED = ([\d.]+)", GraphWidget._esm)[0])
DOCKED = 542  # pixels beside a notebook in a window of 1366


class Busy(Node):
    """One of everything."""

    def __init__(self, name: str = "busy") -> None:
        super().__init__(name)
        self.create_service(AddTwoInts, "add_two_ints", lambda _, response: response)
        self.create_client(AddTwoInts, "missing")
        self.create_publisher(Float64, "temperature", 10)
        self.create_subscription(Bool, "button", lambda _: None, 10)
        self.actions = ActionServer(self, Fibonacci, "fibonacci", lambda _: Fibonacci.Result())


class Display(Node):
    def __init__(self) -> None:
        super().__init__("display", namespace="/kitchen")
        self.create_subscription(Float64, "/temperature", lambda _: None, 10)


class Asking(Node):
    def __init__(self) -> None:
        super().__init__("asking")
        self.create_client(AddTwoInts, "add_two_ints")
        self.goals = ActionClient(self, Fibonacci, "fibonacci")


def nodes_in(view: GraphView) -> list[str]:
    """The nodes drawn, in the order in which Tab reaches them."""
    return re.findall(r'data-node="([^"]*)"', view.widget.svg)


def seen(own: Lab, *, plumbing: bool = False) -> Overview:
    return overview.read_graph(own.engine.node, plumbing=plumbing)


def wait_for(view: GraphView, text: str) -> None:
    """Until the page has been told of `text`."""
    there = threading.Event()

    def look(_: object = None) -> None:
        if text in view.widget.text:
            there.set()

    view.widget.observe(look, "text")
    look()
    assert there.wait(20), view.widget.text


def test_it_says_who_offers_what_who_uses_it_and_what_is_amiss() -> None:
    lab.start(Busy)
    lab.start(Display)
    assert panels.graph().describe() == (
        "busy\n"
        "    serves /add_two_ints [example_interfaces/srv/AddTwoInts]\n"
        "    calls /missing [example_interfaces/srv/AddTwoInts]\n"
        "    runs the action /fibonacci [example_interfaces/action/Fibonacci]\n"
        "    publishes /temperature [std_msgs/msg/Float64]\n"
        "    listens to /button [std_msgs/msg/Bool]\n"
        "/kitchen/display\n"
        "    listens to /temperature [std_msgs/msg/Float64]\n"
        "No node serves /missing.\n"
        "No node publishes /button."
    )


def test_a_topic_without_listeners_and_one_with_two_types_are_remarked_on(live_lab: Lab) -> None:
    lab.start(Busy)
    uses = seen(live_lab).uses
    other = overview.ChannelUse("/other", overview.LISTENS, "/temperature", ("std_msgs/msg/Bool",))
    remarks = overview.Overview(("/busy", "/other"), (*uses, other)).remarks()
    assert seen(live_lab).remarks()["topic", "/temperature"] == ["No node listens to /temperature."]
    assert remarks["topic", "/temperature"] == [
        "/temperature is used with 2 types, which never meet: std_msgs/msg/Bool, std_msgs/msg/Float64."
    ]


def test_plumbing_is_hidden_unless_it_is_asked_for(live_lab: Lab) -> None:
    lab.start(Busy)
    view = panels.graph()
    assert "rosout" not in view.widget.text
    view.widget.plumbing = True
    for name in ("/rosout", "/busy/set_parameters", "/fibonacci/_action/feedback", "_lab_"):
        assert name in view.widget.text
    view.widget.plumbing = False
    assert "rosout" not in view.widget.text
    assert seen(live_lab).remarks() == seen(live_lab, plumbing=True).remarks()


def test_the_page_follows_when_nodes_come_change_and_go_and_a_command_publishes(live_lab: Lab) -> None:
    view = panels.graph()
    assert view.widget.svg == ""
    lab.start(Busy)
    wait_for(view, "serves /add_two_ints")
    assert nodes_in(view) == ["busy"]
    lab.start(Display)
    wait_for(view, "/kitchen/display")
    lab.stop(Busy)
    wait_for(view, "No node publishes /temperature.")
    assert nodes_in(view) == ["/kitchen/display"]
    command = overview.quiet_node("_ros2cli_1", live_lab.engine.node.context)
    command.create_publisher(Float64, "/temperature", 10)
    wait_for(view, "ros2 command\n    publishes /temperature")


def test_a_box_says_what_it_is_and_each_use_is_an_arrow(live_lab: Lab) -> None:
    lab.start(Busy)
    now = seen(live_lab)
    assert boxes_of(now)["node", "/busy"].words == (
        "busy: serves /add_two_ints; calls /missing; runs the action /fibonacci; publishes /temperature; "
        "listens to /button"
    )
    assert boxes_of(now)["topic", "/button"].words == ("topic /button, std_msgs/msg/Bool. No node publishes /button.")
    uses = re.findall(r'data-of="busy" data-verb="([^"]*)" data-kind="[a-z]*" data-on="([^"]*)"', graph_svg(now))
    assert sorted(uses) == [
        ("calls", "/missing"),
        ("listens to", "/button"),
        ("publishes", "/temperature"),
        ("runs the action", "/fibonacci"),
        ("serves", "/add_two_ints"),
    ]


def columns_of(svg: str) -> dict[str, int]:
    """How far to the right each box is."""
    found = re.findall(r'translate\((\d+) \d+\)" [^>]*data-(?:node|channel)="([^"]*)"', svg)
    return {name: int(x) for x, name in found}


def test_it_flows_from_who_begins_to_who_receives(live_lab: Lab) -> None:
    lab.start(Busy)
    lab.start(Display)
    lab.start(Asking)
    places = columns_of(graph_svg(seen(live_lab)))
    assert places["busy"] < places["/temperature"] < places["/kitchen/display"]
    assert places["asking"] < places["/add_two_ints"] < places["busy"]
    assert places["asking"] < places["/fibonacci"] < places["busy"]
    assert places["/button"] < places["busy"] < places["/missing"]


def fifty() -> Overview:
    """A chain of fifty nodes with topics, and services across it."""
    nodes = tuple(f"/station_{number:02}" for number in range(50))
    uses = [overview.ChannelUse(node, overview.PUBLISHES, f"{node}/state", ("std_msgs/msg/Float64",)) for node in nodes]
    for number, node in enumerate(nodes[1:]):
        uses.append(
            overview.ChannelUse(node, overview.LISTENS, f"{nodes[number * 3 % 50]}/state", ("std_msgs/msg/Float64",))
        )
        if number % 6 == 0:
            uses.append(overview.ChannelUse(node, overview.SERVES, f"{node}/reset", ("std_srvs/srv/Trigger",)))
            uses.append(
                overview.ChannelUse(nodes[number // 2], overview.CALLS, f"{node}/reset", ("std_srvs/srv/Trigger",))
            )
    return overview.Overview(nodes, tuple(dict.fromkeys(uses)))


def test_the_words_of_fifty_nodes_do_not_overlap() -> None:
    svg = graph_svg(fifty())
    boxes = re.findall(r'translate\((\d+) (\d+)\)".*?<rect width="(\d+)" height="(\d+)"', svg, flags=re.DOTALL)
    frames = [(int(x), int(y), int(x) + int(w), int(y) + int(h)) for x, y, w, h in boxes]
    assert len(frames) == 50 + 50 + 9
    for one, other in itertools.combinations(frames, 2):
        assert one[2] <= other[0] or other[2] <= one[0] or one[3] <= other[1] or other[3] <= one[1]


@pytest.mark.parametrize("own", [(), ((overview.SENDS_GOALS, "/drive"), (overview.LISTENS, "/deliver/position"))])
def test_parts_that_nothing_or_the_notebook_joins_have_room_in_a_docked_panel(own: tuple[Any, ...]) -> None:
    types = {overview.RUNS: "course_interfaces/action/MoveRobot", overview.PUBLISHES: "geometry_msgs/msg/Point"}
    types |= {overview.SENDS_GOALS: types[overview.RUNS], overview.LISTENS: types[overview.PUBLISHES]}
    uses = [("/carrier", overview.RUNS, "/deliver"), ("/carrier", overview.PUBLISHES, "/deliver/position")]
    uses += [("/robot", overview.RUNS, "/drive"), ("/robot", overview.PUBLISHES, "/drive/position")]
    uses += [("lab", *use) for use in own]
    nodes = tuple(dict.fromkeys(node for node, _, _ in uses))
    drawn = graph_svg(overview.Overview(nodes, tuple(overview.ChannelUse(*use, (types[use[1]],)) for use in uses)))
    assert width_of(drawn) * LEAST_ZOOM <= DOCKED
    assert {line for line in re.findall(r">([^<]*)</text>", drawn) if line.endswith("/")} == {
        "course_interfaces/",
        "geometry_msgs/msg/",
    }


def width_of(drawn: str) -> int:
    return int(re.findall(r'viewBox="-4 -4 (\d+)', drawn)[0])


def test_a_service_that_asks_another_one_is_not_cut_off_in_a_docked_panel() -> None:
    nodes, types = ("/doubler", "/minimal_service"), ("example_interfaces/srv/AddTwoInts",)
    roles = [(overview.SERVES, "/double"), (overview.CALLS, "/add_two_ints"), (overview.SERVES, "/add_two_ints")]
    uses = (overview.ChannelUse(nodes[number // 2], *role, types) for number, role in enumerate(roles))
    drawn = graph_svg(overview.Overview(nodes, tuple(uses)), {node: ["01_services.ipynb"] for node in nodes})
    assert width_of(drawn) * LEAST_ZOOM <= DOCKED


def crossed(view: GraphView) -> list[tuple[object, ...]]:
    """The hops that a page is told from now on, in the order of their stages; filled while messages cross."""
    told: list[tuple[object, ...]] = []

    def tell(change: dict[str, Any]) -> None:
        told.extend((hop["node"], hop["verb"], hop["channel"], hop["leaves"]) for hop in change["new"]["hops"])

    view.widget.observe(tell, "crossed")
    return told


def test_a_message_that_crosses_is_told_and_nothing_else_is() -> None:
    lab.start(Display)
    view = panels.graph()
    told = crossed(view)
    assert told == []
    lab.publish("/temperature", Float64, data=1.0)
    wait_until(lambda: len(told) == 2)
    assert set(told) == {
        ("lab", "publishes", "/temperature", True),
        ("/kitchen/display", "listens to", "/temperature", False),
    }
    wait_until(lambda: 'data-node="lab"' in view.widget.svg)
    assert "\nlab, this notebook" in view.widget.text


def test_a_call_goes_there_and_comes_back() -> None:
    lab.start(Busy)
    view = panels.graph()
    told = crossed(view)
    lab.call_blocking("/add_two_ints", AddTwoInts, a=1, b=2)
    wait_until(lambda: len(told) == 4)
    assert set(told) == {
        ("lab", "calls", "/add_two_ints", True),
        ("busy", "serves", "/add_two_ints", False),
        ("busy", "serves", "/add_two_ints", True),
        ("lab", "calls", "/add_two_ints", False),
    }


def test_a_fast_topic_is_counted_and_does_not_flood_the_page() -> None:
    lab.start(Display)
    view = panels.graph()
    counts: list[int] = []
    view.widget.observe(
        lambda change: counts.extend(hop["count"] for hop in change["new"]["hops"] if hop["node"] == "lab"), "crossed"
    )
    began = time.monotonic()
    for number in range(300):
        lab.publish("/temperature", Float64, data=float(number))
    wait_until(lambda: sum(counts) == 300)
    assert len(counts) <= 1 + RATE * (time.monotonic() - began)


def test_an_export_shows_the_graph_as_it_is(live_lab: Lab) -> None:
    lab.start(Display)
    html = panels.graph()._repr_mimebundle_()["text/html"]
    assert 'data-node="/kitchen/display"' in html
    assert "<svg" in html
    assert not re.findall(r"https?:|<script|url\(", html)
    lab.stop()
    assert "No node is on the ROS graph." in panels.graph()._repr_mimebundle_()["text/html"]
    assert not live_lab.live_nodes()


def test_what_came_and_left_is_told_to_a_screen_reader(live_lab: Lab) -> None:
    empty = seen(live_lab)
    lab.start(Display)
    full = seen(live_lab)
    assert news(empty, full) == "/kitchen/display has joined the graph."
    assert news(full, empty) == "/kitchen/display has left the graph."
    assert not news(full, full._replace(uses=()))  # what a node does comes a moment after its name


def test_a_node_of_another_notebook_says_so() -> None:
    graph = overview.Overview(("/mine", "/robot", "/twin", "/twin"), ())
    others = notebooks_by_node([OtherNotebook("02_actions.ipynb", ("/robot", "/twin"), "/_lab_1")])
    boxes = boxes_of(graph, others)
    assert boxes["node", "/robot"].words == "robot in 02_actions.ipynb: nothing yet"
    assert boxes["node", "/twin"].words == "twin (2 nodes of this name) also in 02_actions.ipynb: nothing yet"
    assert [name for (_, name), box in boxes.items() if box.elsewhere] == ["/robot"]
    svg = graph_svg(graph, others)
    assert svg.count("ck-elsewhere") == 1
    assert svg.count(">in 02_actions.ipynb<") == 1
    assert "in 02_actions" not in graph_svg(graph)


def test_it_ends_when_another_one_is_shown_and_with_the_lab(live_lab: Lab) -> None:
    first, second = panels.graph(), panels.graph()
    assert (first.widget.ended, second.widget.ended) == (True, False)
    watching = [thread for thread in threading.enumerate() if thread.name == "graph-view"]
    assert len(watching) == 1
    told, told_too = crossed(first), crossed(second)
    lab.publish("/temperature", Float64, data=1.0)
    wait_until(lambda: told_too)
    assert told == []
    live_lab.close()
    assert second.widget.ended
    assert not watching[0].is_alive()


def test_a_page_and_the_watching_thread_do_not_meet(live_lab: Lab) -> None:
    """Ticking the box while nodes come and go shows what there is."""
    view: Any = panels.graph()
    for number in range(5):
        lab.start(Busy, f"busy{number}")
        view.widget.plumbing = not view.widget.plumbing
    view.widget.plumbing = False
    wait_for(view, "busy4")
    assert view.widget.text == in_lines(seen(live_lab))
