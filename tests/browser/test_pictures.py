"""Pictures in the browser where there is more to show, or less around them: fifty nodes, Notebook 7, an export."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.learner import ARTIFACTS
from tests.browser.pictures import offline_page, require_no_findings
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab, OpenServer

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


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
        pictures = shown.locator(".ck-still, .ck-exchange, .ck-times")
        for one in pictures.all():
            one.scroll_into_view_if_needed()
            frame = one.bounding_box()
            assert frame is not None
            assert frame["height"] > 40
        require_no_findings(shown, pictures)
        shown.set_viewport_size({"width": 640, "height": 768})  # as beside a docked panel: no name is cut off
        for drawn in shown.locator(".ck-exchange .ck-scroll").all():
            assert drawn.evaluate("frame => frame.scrollWidth <= frame.clientWidth")
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
