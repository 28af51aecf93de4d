"""The picture of the ROS graph: what it shows, that it follows, that it ends."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import pytest
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

from course_kit import lab, panels
from course_kit.panels.graph_view import GraphView, drawn, in_lines, news
from course_kit.ros import graph as overview

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab
    from course_kit.ros.graph import Overview

pytestmark = pytest.mark.usefixtures("live_lab")


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


def seen(own: Lab, *, plumbing: bool = False) -> Overview:
    return overview.read(own.engine.node, plumbing=plumbing)


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


def test_an_empty_graph_says_so() -> None:
    assert panels.graph().describe() == "No node is on the ROS graph."


def test_a_topic_without_listeners_and_one_with_two_types_are_remarked_on(live_lab: Lab) -> None:
    lab.start(Busy)
    uses = seen(live_lab).uses
    other = overview.Use("/other", overview.LISTENS, "/temperature", ("std_msgs/msg/Bool",))
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
    assert "rosout" not in view.describe()
    view.widget.plumbing = False
    assert "rosout" not in view.widget.text
    assert seen(live_lab).remarks() == seen(live_lab, plumbing=True).remarks()


def test_the_page_follows_when_nodes_come_change_and_go() -> None:
    view = panels.graph()
    assert view.widget.nodes == []
    lab.start(Busy)
    wait_for(view, "serves /add_two_ints")
    assert [node["name"] for node in view.widget.nodes] == ["busy"]
    lab.start(Display)
    wait_for(view, "/kitchen/display")
    lab.stop(Busy)
    wait_for(view, "No node publishes /temperature.")
    assert [node["name"] for node in view.widget.nodes] == ["/kitchen/display"]


def test_each_use_leads_to_its_channel(live_lab: Lab) -> None:
    lab.start(Busy)
    nodes, channels = drawn(seen(live_lab))
    lines = {use["verb"]: (channels[use["channel"]]["name"], use["inward"]) for use in nodes[0]["uses"]}
    assert lines == {
        "serves": ("/add_two_ints", True),
        "calls": ("/missing", False),
        "runs the action": ("/fibonacci", True),
        "publishes": ("/temperature", False),
        "listens to": ("/button", True),
    }
    # In the order of the uses, so that these lines do not cross.
    assert [use["channel"] for use in nodes[0]["uses"]] == [0, 1, 2, 3, 4]


def test_what_came_and_left_is_told_to_a_screen_reader(live_lab: Lab) -> None:
    empty = seen(live_lab)
    lab.start(Display)
    full = seen(live_lab)
    assert news(empty, full) == "/kitchen/display has joined the graph."
    assert news(full, empty) == "/kitchen/display has left the graph."
    assert news(full, full._replace(uses=())) == "The graph has changed."


def test_what_a_node_does_is_no_news_right_after_its_coming(live_lab: Lab) -> None:
    """The graph tells of a node first and of its topics a moment later."""
    empty = seen(live_lab)
    lab.start(Display)
    full = seen(live_lab)
    view = panels.graph()
    view._came = frozenset(full.nodes) - frozenset(empty.nodes)
    assert view._completes(full._replace(uses=()), full)
    assert not view._completes(empty, full)
    view._came = frozenset()
    assert not view._completes(full._replace(uses=()), full)


def test_two_nodes_of_one_name_are_told_apart_from_one() -> None:
    twice = overview.Overview(("/twin", "/twin"), ())
    assert in_lines(twice) == "twin (2 nodes of this name)"
    assert drawn(twice)[0][0]["note"] == "(2 nodes of this name)"


def test_it_ends_when_another_one_is_shown_and_with_the_lab(live_lab: Lab) -> None:
    first, second = panels.graph(), panels.graph()
    assert (first.widget.ended, second.widget.ended) == (True, False)
    watching = [thread for thread in threading.enumerate() if thread.name == "graph-view"]
    assert len(watching) == 1
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
