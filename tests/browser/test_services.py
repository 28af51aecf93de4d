"""Lessons 0 and 1 in the browser: the graph that follows, the form that calls."""

from __future__ import annotations

import json
import os
import re
import subprocess
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from course_kit.quiz import guesses
from tests.browser.pictures import photograph

if TYPE_CHECKING:
    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


def require_nothing_told_and_nothing_unsaved(lab: JupyterLab) -> None:
    """A lesson that has just been opened: no output spoils a guess, and its tab shows no unsaved change."""
    tab = lab.page.locator("#jp-main-dock-panel .lm-TabBar-tab", has_text="00_welcome.ipynb")
    expect(tab).to_have_count(1)
    assert "jp-mod-dirty" not in (tab.get_attribute("class") or "")
    cells = json.loads((lab.root / "notebooks/00_welcome.ipynb").read_text())["cells"]
    assert not any(cell.get("outputs") for cell in cells)
    # A change is shown there, so its absence means something.
    lab.page.locator(".jp-CodeCell .cm-content").first.click()
    lab.page.keyboard.type(" ")
    expect(tab).to_have_class(re.compile("jp-mod-dirty"))
    lab.page.keyboard.press("Backspace")


def guess_wrong_then_right_by_keyboard(lab: JupyterLab) -> None:
    """The arrow keys only choose; Enter guesses. The first try is what `./course list` counts."""
    name = "00_welcome/after_the_cell"
    asked = guesses.question(name)
    lab.run_cell_that_begins(f'panels.guess("{name}")')
    panel = lab.scroll_to(lab.page.locator(".ck-guess"))
    photograph(lab, panel, "guess_before")
    verdict, send = panel.get_by_role("status").first, panel.get_by_role("button", name="This is my guess")
    expect(send).to_be_disabled()
    wrong = next(choice for choice in asked.choices if not choice.is_right)
    choose(panel, asked.choices.index(wrong))
    expect(send).to_be_enabled()
    expect(verdict).to_be_hidden()
    lab.page.keyboard.press("Enter")
    expect(verdict).to_contain_text(f"Not quite. {wrong.why}")
    expect(verdict).to_contain_text("The answer: It lives on and keeps publishing.")
    expect(verdict).to_be_focused()
    photograph(lab, panel, "guess_after")
    panel.get_by_role("button", name="Try again").press("Enter")
    choose(panel, asked.right)
    lab.page.keyboard.press("Enter")
    expect(verdict).to_contain_text("Right.")
    # Shift+Enter goes on below the guess, and asks nothing again.
    lab.page.keyboard.press("Shift+Enter")
    expect(lab.page.locator(".jp-Cell:has(.ck-guess) + .jp-Cell")).to_have_class(re.compile("jp-mod-active"))
    expect(verdict).to_contain_text("Right.")
    kept = {**os.environ, "COURSE_KIT_PROGRESS": ""}
    command = [lab.root / "course", "list"]
    listed = subprocess.run(command, cwd=lab.root, env=kept, capture_output=True, text=True, check=True)
    assert "00_welcome: guesses right: 0 of 3 (1 answered)" in listed.stdout


def choose(panel: Locator, place: int) -> None:
    """Move to a choice with the arrow keys, from the first one."""
    panel.get_by_role("radio").first.focus()
    for key in ["Space", *["ArrowDown"] * place]:
        panel.page.keyboard.press(key)
    expect(panel.get_by_role("radio").nth(place)).to_be_checked()


def test_lesson_zero_shows_nodes_come_and_go(lab: JupyterLab) -> None:
    lab.open("notebooks/00_welcome.ipynb")
    require_nothing_told_and_nothing_unsaved(lab)
    lab.run_cell_that_begins("%load_ext course_kit")
    guess_wrong_then_right_by_keyboard(lab)
    lab.run_cell_that_begins("graph = panels.graph()")
    graph = lab.page.locator(".ck-graph")
    expect(graph).to_contain_text("No node is on the graph.")
    lab.run_cell_that_begins("from rclpy.node import Node")
    lab.scroll_to(graph)
    expect(graph.locator("[data-node=battery]")).to_contain_text("publishes")
    expect(graph.locator("[data-channel='/battery_voltage']")).to_contain_text("No node listens to /battery_voltage.")
    expect(graph.get_by_role("status")).to_have_text("battery has joined the graph.")
    lab.picture("lesson_zero_one_node")

    lab.run_cell_that_begins("class Dashboard(Node)")
    lab.scroll_to(graph)
    expect(graph.locator("[data-channel='/battery_voltage']")).not_to_contain_text("No node listens")
    expect(graph.locator(".ck-use[data-of=battery]")).to_have_count(1)
    graph.locator("[data-node=dashboard]").focus()
    expect(graph.locator(".ck-use.ck-on")).to_have_attribute("data-of", "dashboard")
    graph.get_by_text("The same as text").click()
    expect(graph.get_by_label("The graph as text")).to_contain_text(
        "listens to /battery_voltage [std_msgs/msg/Float64]"
    )
    lab.picture("lesson_zero_two_nodes")

    graph.get_by_label("Show ROS's own plumbing too").check()
    expect(graph.locator("[data-channel='/rosout']")).to_be_visible()
    graph.get_by_label("Show ROS's own plumbing too").uncheck()
    expect(graph.locator("[data-channel='/rosout']")).to_have_count(0)


def test_lesson_one_answers_the_form_and_draws(lab: JupyterLab) -> None:
    page = lab.page
    lab.open("notebooks/01_services.ipynb")
    lab.run_all()
    lab.require_no_error("notebooks/01_services.ipynb")
    diagram = lab.scroll_to(page.locator(".ck-exchange svg", has_text="/add_two_ints request: a=1, b=2"))
    expect(diagram).to_be_visible()
    lab.picture("lesson_one_diagram")
    stuck = lab.scroll_to(page.locator(".ck-times", has_text="stuck_double"))
    expect(stuck).to_contain_text("has not ended")
    photograph(lab, stuck, "timeline_deadlock")

    # The lesson ends with lab.stop(); its cells can be run again one by one.
    lab.run_cell_that_begins("class MinimalService(Node)")
    form = lab.scroll_to(page.locator(".ck-form[aria-label='Call /add_two_ints']"))
    form.get_by_label("a", exact=True).fill("20")
    form.get_by_label("b", exact=True).fill("1.5")
    page.keyboard.press("Enter")
    outcome = form.get_by_role("status")
    expect(outcome).to_contain_text("b: expected a whole number")
    expect(form.get_by_label("b", exact=True)).to_be_focused()
    expect(form.get_by_label("b", exact=True)).to_have_attribute("aria-invalid", "true")
    lab.picture("lesson_one_form_refuses")
    page.keyboard.press("Control+A")
    page.keyboard.type("22")
    page.keyboard.press("Enter")
    expect(outcome.get_by_role("row", name="sum")).to_contain_text("42")
    expect(outcome).to_contain_text("1. lab -> minimal_service /add_two_ints request: a=20, b=22")
    expect(outcome).to_contain_text("[INFO] [minimal_service]: Incoming request")
    expect(form.get_by_label("b", exact=True)).not_to_have_attribute("aria-invalid", "true")
    lab.picture("lesson_one_form_answers")


def test_a_form_for_any_type_is_filled_in_by_keyboard(lab: JupyterLab) -> None:
    page = lab.page
    lab.open("notebooks/01_services.ipynb")
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.replace_cell_that_begins("from course_kit.interfaces import text_of", TOUR)
    lab.run_cell_that_begins("from course_kit import interfaces")
    form = lab.scroll_to(page.locator(".ck-form[aria-label='Call /tour']"))
    form.get_by_role("button", name="MODE_FAST = 2").click()
    expect(form.get_by_role("textbox", name="mode")).to_have_value("2")
    form.get_by_label("guided").focus()
    page.keyboard.press("Space")
    form.get_by_role("button", name="Add one to stops").focus()
    page.keyboard.press("Enter")
    form.get_by_label("x", exact=True).fill("3.5")
    page.keyboard.press("Enter")
    outcome = form.get_by_role("status")
    expect(outcome.get_by_role("row", name="message")).to_contain_text("mode 2, guided True, stop at 3.5")
    outcome.scroll_into_view_if_needed()
    lab.picture("form_for_any_type")


TOUR = """from course_kit import interfaces
from rclpy.node import Node

Tour = interfaces.define(
    "my_interfaces/srv/Tour",
    "uint8 MODE_SLOW=1\\nuint8 MODE_FAST=2\\nuint8 mode\\nbool guided\\ngeometry_msgs/Point[] stops"
    "\\n---\\nstring message",
)


class Guide(Node):
    def __init__(self):
        super().__init__("guide")
        self.create_service(Tour, "tour", self.lead)

    def lead(self, request, response):
        response.message = f"mode {request.mode}, guided {request.guided}, stop at {request.stops[0].x}"
        return response


lab.start(Guide)
panels.service_form("/tour", Tour)"""
