"""Pictures that move, in the browser: the graph with its messages, the diagram with its slider."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.learner import ARTIFACTS
from tests.browser.pictures import offline_page, photograph, require_no_findings
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab, OpenServer

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

# Notes each dot that begins to run, where its two halves of a way lead.
WATCH_DOTS = """() => {
  window.dots = [];
  new MutationObserver(changes => {
    for (const { addedNodes } of changes)
      for (const one of addedNodes)
        if (one.classList?.contains("ck-dot"))
          window.dots.push(`${one.dataset.way} ${one.dataset.of} ${one.dataset.on}`);
  }).observe(document.body, { childList: true, subtree: true });
}"""

# Whether a second goes by in which none begins.
NO_MORE_DOTS = """() => new Promise(done => {
  const before = window.dots.length;
  setTimeout(() => done(window.dots.length === before), 1000);
})"""


def middle_of(shown: Locator) -> float:
    frame = shown.bounding_box()
    assert frame is not None
    return frame["x"] + frame["width"] / 2


def open_graph_of_lesson_zero(lab: JupyterLab) -> Locator:
    lab.open("notebooks/00_welcome.ipynb")
    for start in (
        "%load_ext course_kit",
        "graph = panels.graph()",
        "from rclpy.node import Node",
        "class Dashboard(Node)",
    ):
        lab.run_cell_that_begins(start)
    graph = lab.page.locator(".ck-graph").first
    lab.scroll_to(graph)
    expect(graph.locator("[data-node=dashboard]")).to_be_visible()
    expect(graph.locator(".ck-use[data-of=battery]")).to_have_count(1)
    expect(graph.locator(".ck-use[data-of=dashboard]")).to_have_count(1)
    return graph


def run_elsewhere(lab: JupyterLab, code: str) -> None:
    """Run a line in the notebook's kernel while the graph stays in view."""
    lab.page.evaluate(
        """async code => {
            const panel = [...window.jupyterapp.shell.widgets("main")].find(one => one.sessionContext && one.context);
            await panel.sessionContext.session.kernel.requestExecute({ code }).done;
        }""",
        code,
    )


def test_messages_run_along_the_arrows_of_the_graph_as_they_cross(lab: JupyterLab) -> None:
    graph = open_graph_of_lesson_zero(lab)
    places = [
        middle_of(graph.locator(one)) for one in ("[data-node=battery]", ".ck-box.ck-topic", "[data-node=dashboard]")
    ]
    assert places == sorted(places)
    lab.page.evaluate(WATCH_DOTS)
    lab.page.wait_for_function("window.dots.length >= 4")  # the battery's own messages
    photograph(lab, graph, "graph")

    run_elsewhere(lab, QUIET)
    expect(graph.locator(".ck-use[data-of=dashboard]")).to_be_attached()
    lab.page.wait_for_function(NO_MORE_DOTS)
    lab.page.evaluate("window.dots.length = 0")
    run_elsewhere(lab, "battery.publisher.publish(Float64(data=11.0))")
    lab.page.wait_for_function("window.dots.length >= 2")
    assert lab.page.evaluate("window.dots") == ["out battery /battery_voltage", "in dashboard /battery_voltage"]
    expect(graph.locator(".ck-dot")).to_have_count(0)

    # What no eye can follow is a number, and no dot moves.
    run_elsewhere(lab, "for n in range(40): battery.publisher.publish(Float64(data=float(n)))")
    expect(graph.locator(".ck-rate").first).to_have_text(re.compile(r"\d+/s"))
    expect(graph.locator(".ck-rate")).to_have_count(0)
    lab.page.emulate_media(reduced_motion="reduce")
    lab.page.evaluate("window.dots.length = 0")
    run_elsewhere(lab, "battery.publisher.publish(Float64(data=11.0))")
    expect(graph.locator(".ck-crossed").first).to_be_attached()
    assert lab.page.evaluate("window.dots") == []


def test_the_graph_is_docked_beside_the_notebook_in_one_click(lab: JupyterLab) -> None:
    graph = open_graph_of_lesson_zero(lab)
    graph.get_by_role("button", name="Dock beside the notebook").click()
    docked = lab.page.locator(".jp-LinkedOutputView .ck-graph")
    expect(docked.locator("[data-node=dashboard]")).to_be_visible()
    expect(docked.get_by_role("button", name="Dock beside the notebook")).to_have_count(0)
    notebook = lab.page.locator(".jp-NotebookPanel").bounding_box()
    beside = docked.bounding_box()
    assert notebook is not None
    assert beside is not None
    assert beside["x"] >= notebook["x"] + notebook["width"]
    expect(docked.locator(".ck-dot").first).to_be_attached()
    lab.picture("graph_docked")
    # The keyboard goes on in the notebook, below the panel's cell, and docks nothing again.
    below = lab.page.locator(".jp-Cell:has(.ck-graph) + .jp-Cell")
    expect(below).to_have_class(re.compile("jp-mod-active"))
    for _ in range(2):
        lab.page.keyboard.press("Shift+Enter")
    expect(below).not_to_have_class(re.compile("jp-mod-active"))
    graph.get_by_role("button", name="Dock beside the notebook").click()
    expect(lab.page.locator(".lm-TabBar-tabLabel", has_text="ROS graph")).to_have_count(1)


def test_in_notebook_7_the_graph_floats_over_the_page_and_goes_back(lab: JupyterLab) -> None:
    page = lab.page
    lab.open_in_notebook_7("notebooks/00_welcome.ipynb")
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.run_cell_that_begins("graph = panels.graph()")
    page.get_by_role("button", name="Float over the page").click()
    floating = page.locator(".ck-floating .ck-graph")
    expect(floating).to_be_in_viewport()
    lab.run_cell_that_begins("from rclpy.node import Node")
    expect(floating.locator("[data-node=battery]")).to_be_in_viewport()
    lab.picture("graph_notebook_7")
    floating.get_by_role("button", name="Put back into the notebook").click()
    expect(page.locator(".jp-OutputArea .ck-graph [data-node=battery]")).to_be_visible()
    expect(page.locator(".ck-floating")).to_have_count(0)


def test_the_diagram_is_gone_through_by_keyboard_in_any_theme(lab: JupyterLab) -> None:
    page = lab.page
    lab.open("notebooks/01_services.ipynb")
    for start in (
        "%load_ext course_kit",
        "from rclpy.node import Node",
        "from example_interfaces.srv import AddTwoInts",
    ):
        lab.run_cell_that_begins(start)
    lab.run_cell_that_begins("class MinimalService(Node)")
    lab.run_cell_that_begins("lab.record()")
    lab.replace_cell_that_begins("lab.diagram()", LONG)
    lab.run_cell_that_begins("class Chatty(Node)")
    drawn = lab.scroll_to(page.locator(".ck-exchange", has_text="word"))
    slider = drawn.get_by_role("slider")
    steps = drawn.locator(".ck-step")
    count = steps.count()
    assert count >= 6
    expect(drawn.locator(".ck-later")).to_have_count(0)
    slider.click()
    expect(slider).to_be_focused()
    page.keyboard.press("Home")
    expect(drawn.locator(".ck-later")).to_have_count(count - 1)
    expect(drawn.locator("output")).to_have_text(f"1 of {count}")
    expect(slider).to_be_focused()
    page.keyboard.press("ArrowRight")
    expect(drawn.locator(".ck-later")).to_have_count(count - 2)
    expect(drawn.locator(".ck-current")).to_have_count(1)
    expect(slider).to_have_attribute("aria-valuetext", re.compile(f"^2 of {count}: minimal_service -> lab"))
    photograph(lab, drawn, "diagram")
    page.keyboard.press("End")
    expect(drawn.locator(".ck-later")).to_have_count(0)


def test_an_export_shows_each_panel_and_diagram_offline(tmp_path: Path, jupyter: OpenServer) -> None:
    """Of the notebook as it is stored, with nothing but the file itself."""
    source = REPOSITORY / "notebooks" / "02_actions.ipynb"
    command = [sys.executable, "-m", "nbconvert", "--to", "html", "--output-dir", str(tmp_path), str(source)]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    with offline_page(jupyter.chromium) as shown:
        shown.goto((tmp_path / "02_actions.html").as_uri())
        for selector, count in STILL.items():
            expect(shown.locator(selector)).to_have_count(count)
        answers = shown.locator("details")
        assert answers.evaluate_all("all => all.every(one => !one.open && one.children.length > 1)")
        for one in shown.locator(".ck-still, .ck-exchange, .ck-times").all():
            one.scroll_into_view_if_needed()
            frame = one.bounding_box()
            assert frame is not None
            assert frame["height"] > 40
            require_no_findings(shown, one)
        for drawn in shown.locator("main img[alt]").all():
            assert drawn.evaluate("image => image.naturalWidth") > 100
        ARTIFACTS.mkdir(parents=True, exist_ok=True)
        shown.screenshot(path=ARTIFACTS / "export.png")


# How many of what the export of lesson 2 shows.
STILL = {".ck-exchange": 2, ".ck-times": 1, ".ck-still": 3, ".ck-drawn": 2, ".ck-still-map": 1}


def test_fifty_nodes_stay_readable(lab: JupyterLab) -> None:
    page = lab.page
    lab.open("notebooks/00_welcome.ipynb")
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.replace_cell_that_begins("graph = panels.graph()", FIFTY)
    lab.run_cell_that_begins("from std_msgs.msg import Float64")
    graph = lab.scroll_to(page.locator(".ck-graph"))
    expect(graph.locator(".ck-box.ck-node")).to_have_count(50)
    expect(graph.locator(".ck-box.ck-topic")).to_have_count(50)
    assert smallest_text(graph) >= 9
    assert overlapping(graph) == []
    graph.get_by_role("button", name="Fit all of it into the frame").click()
    frame = graph.locator(".ck-picture")
    assert frame.evaluate("frame => frame.scrollWidth <= frame.clientWidth")
    lab.picture("graph_fifty_fitted")


def smallest_text(graph: Locator) -> float:
    found: float = graph.locator("text").evaluate_all(
        "all => Math.min(...all.map(one => one.getBoundingClientRect().height))"
    )
    return found


def overlapping(graph: Locator) -> list[str]:
    """Pairs of texts that are painted over each other, or over the frame of another box."""
    found: list[str] = graph.evaluate(
        """graph => {
            const boxes = [...graph.querySelectorAll(".ck-box")];
            const frames = boxes.map(box => box.querySelector("rect").getBoundingClientRect());
            const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
            const wrong = [];
            boxes.forEach((box, number) => {
                for (const text of box.querySelectorAll("text")) {
                    const own = text.getBoundingClientRect();
                    const inside = own.right <= frames[number].right && own.bottom <= frames[number].bottom;
                    if (!inside) wrong.push(text.textContent);
                    frames.forEach((frame, other) => {
                        if (other !== number && !apart(own, frame)) wrong.push(`${text.textContent} on ${other}`);
                    });
                }
            });
            return wrong;
        }"""
    )
    return found


# The battery of the lesson without its timer.
QUIET = """lab.stop("battery")

class Quiet(Node):
    def __init__(self):
        super().__init__("battery")
        self.publisher = self.create_publisher(Float64, "battery_voltage", 10)

battery = lab.start(Quiet)"""
# A node whose messages are long.
LONG = """class Chatty(Node):
    def __init__(self):
        super().__init__("chatty")
        self.create_subscription(String, "said", self.hear, 10)
        self.publisher = self.create_publisher(String, "echo", 10)

    def hear(self, message):
        self.publisher.publish(message)

from std_msgs.msg import String
lab.start(Chatty)
await lab.call("/add_two_ints", AddTwoInts, a=3, b=4)
lab.publish("/said", String, data="word " * 20)
lab.diagram()"""
FIFTY = """from std_msgs.msg import Float64
from rclpy.node import Node


class Station(Node):
    def __init__(self, number):
        super().__init__(f"station_{number:02}")
        self.publisher = self.create_publisher(Float64, f"station_{number:02}/state", 10)
        if number:
            before = f"station_{(number - 1) // 3 if number % 2 else number - 1:02}/state"
            self.create_subscription(Float64, before, lambda message: None, 10)


for number in range(50):
    lab.start(Station, number)
graph = panels.graph()
graph"""
